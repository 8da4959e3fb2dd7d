#define EMISSION_TEXTURE 5
#define SUMS 6
#define OCTREE_NODES 7
#define OCTREE_RECORDS 8
#define EXCHANGED 9
#define FLOATS 10
#define DROPPED 11
#define BLOCK_MARKS 12
#include "voxels/raster_fragment.glsl"
