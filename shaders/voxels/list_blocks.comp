// Lists the blocks of a dense volume that voxelizers marked, and those that were listed before: what is no longer
// there has to be emptied.
#define BLOCKS 1
#define BLOCK_ACCESS LUMO_READ_WRITE
#include "voxels/block_list.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    uint side;  // of the volume, in blocks
    uint keep;  // 1: a block stays listed as long as this is 1
} push;

// A word a block. Bit 0: marked since; bit 1: was listed.
layout(binding = 0, std430) LUMO_READ_WRITE buffer Marks { uint data[]; } marks;

void main() {
    uint number = gl_GlobalInvocationID.x;
    if (number >= push.side * push.side * push.side) return;
    uint mark = marks.data[number];
    if (mark == 0u) return;
    marks.data[number] = push.keep != 0u ? 2u : (mark & 1u) << 1;
    uint place = atomicAdd(blocks.each.count, 1u);
    atomicMax(blocks.each.groups_x, min(place + 1u, max_block_groups));
    atomicMax(blocks.each.groups_y, place / max_block_groups + 1u);
    uint eighth = place / 8u;
    atomicMax(blocks.eight.groups_x, min(eighth + 1u, max_block_groups));
    atomicMax(blocks.eight.groups_y, eighth / max_block_groups + 1u);
    uint row = number / push.side;
    blocks.data[place] = number % push.side | row % push.side << 10 | row / push.side << 20;
}
