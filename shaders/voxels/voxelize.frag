#define EMISSION_TEXTURE 5
#define SUMS 6
ivec3 sum_cell(ivec3 voxel) { return voxel; }
#include "voxels/raster_fragment.glsl"
