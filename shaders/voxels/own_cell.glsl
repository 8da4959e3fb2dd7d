// Which cell a thread of a group of 4 x 4 x 4 is for: of a dense volume, in the listed blocks; of an octree, in its
// list of voxels. The includer defines BLOCKS.
#include "voxels/blocks.glsl"
#include "voxels/octree.glsl"

// Negative where there is none; an octree's may lie beyond its list.
ivec3 own_cell() {
    if (octree_levels > 0) return ivec3(gl_GlobalInvocationID);
    return first_of_block(group_number()) + ivec3(gl_LocalInvocationID);
}
