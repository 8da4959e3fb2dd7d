#define EMISSION_TEXTURE 5
#define SUMS 6
#define LARGE_ARGUMENTS 7
#define LARGE_LIST 8
#define OCTREE_NODES 9
#define OCTREE_RECORDS 10
#define BLOCK_MARKS 11
#include "voxels/large_triangles.glsl"
