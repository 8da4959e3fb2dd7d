// The blocks of voxels/block_list.glsl for who visits them. The includer defines BLOCKS.
#define BLOCK_ACCESS readonly
#include "voxels/block_list.glsl"

uint group_number() { return gl_WorkGroupID.y * max_block_groups + gl_WorkGroupID.x; }

// First voxel of a block by its place in the list; negative beyond its end.
ivec3 first_of_block(uint place) {
    uint block = blocks.data[min(place, max(blocks.each.count, 1u) - 1u)];
    return place < blocks.each.count ? ivec3(uvec3(block, block >> 10, block >> 20) & 1023u) * block_side
                                     : ivec3(-block_side);
}
