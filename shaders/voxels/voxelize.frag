#define EMISSION_TEXTURE 5
#define SUMS 6
#define OCTREE_NODES 7
#define OCTREE_RECORDS 8
#include "voxels/raster_fragment.glsl"
