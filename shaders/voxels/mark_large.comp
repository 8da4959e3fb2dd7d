#define MARKS 5
#define LARGE_ARGUMENTS 6
#define LARGE_LIST 7
#define FRAGMENTS 8
#include "voxels/large_triangles.glsl"
