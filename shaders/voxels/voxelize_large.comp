#define EMISSION_TEXTURE 5
#define SUMS 6
#define LARGE_ARGUMENTS 7
#define LARGE_LIST 8
ivec3 sum_cell(ivec3 voxel) { return voxel; }
#include "voxels/large_triangles.glsl"
