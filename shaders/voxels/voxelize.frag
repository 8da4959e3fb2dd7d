#define EMISSION_TEXTURE 5
#define SUMS 6
#define OCTREE_NODES 7
#define OCTREE_RECORDS 8
#define BLOCK_MARKS 9
#include "voxels/raster_fragment.glsl"
