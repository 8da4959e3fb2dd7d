#define FORMAT rgba16f
#include "voxels/octree_mip.glsl"
