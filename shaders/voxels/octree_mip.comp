#define FORMAT rgba8
#include "voxels/octree_mip.glsl"
