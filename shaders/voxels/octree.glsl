// A sparse voxel octree without pointers.
//
// Level 0 has 2^octree_levels voxels a side, every further level half as many, level octree_levels one. A node is a
// cube of 4 x 4 x 4 voxels of its level; it exists if any of them is occupied, or any that follows them on the far
// side of an axis. So a node has children (the eight nodes of the next finer level that it covers) only where there is
// something, and its parent always exists.
//
// Which nodes exist is a bit each, in the layout of voxels/occupancy.glsl with nodes in place of voxels, in a volume
// with a mip per level: texel (bits, rank), where rank counts the nodes of the pool before this word. Rank and the bits
// below its own give a node its slot, which is where its values lie: nothing is chased from parent to child, and the
// same scene has the same slots on every device. The levels of 4, 2 and 1 voxels a side have one node, in slots 2, 1
// and 0.
//
// A node's values are a brick of 5 x 5 x 5 texels in a pool: its voxels and the next ones on the far sides, so that the
// neighbours of every place in the node are texels of its own brick. Level 0 has one pool, all other levels another.

#include "voxels/occupancy.glsl"

layout(constant_id = 24) const int octree_levels = 0;  // 0: voxels lie in a dense volume

const int brick_voxels = 4;
const int brick_side = 5;  // texels

int octree_side(int level) { return 1 << (octree_levels - level); }

// Slot of a node in its pool, or -1 where it does not exist.
int node_slot(usampler3D nodes, ivec3 node, int level) {
    int depth_side = octree_levels - level;
    if (depth_side <= 2) return depth_side;
    uvec2 word = texelFetch(nodes, occupancy_texel(node), level).xy;
    uint bit = 1u << occupancy_bit(node);
    return (word.x & bit) != 0u ? int(word.y) + bitCount(word.x & (bit - 1u)) : -1;
}

// Bricks lie side by side in a square that grows with the octree, then square upon square along z.
int bricks_a_row_log2(int level) { return octree_levels - (level == 0 ? 3 : 4); }

// First texel of a brick in its pool.
ivec3 brick_texel(int slot, int level) {
    int shift = bricks_a_row_log2(level);
    int mask = (1 << shift) - 1;
    return ivec3(slot & mask, slot >> shift & mask, slot >> 2 * shift) * brick_side;
}

// Occupied voxels are listed in volumes of 128 x 128 x n cells.
ivec3 cell_of_place(uint place) { return ivec3(uvec3(place, place >> 7, place >> 14) & uvec3(127u, 127u, ~0u)); }
uint place_of_cell(ivec3 cell) { return uint(cell.x | cell.y << 7 | cell.z << 14); }

// Where level 0's pool has a voxel; negative where no node has it.
ivec3 voxel_texel(usampler3D nodes, ivec3 voxel) {
    int slot = node_slot(nodes, voxel >> 2, 0);
    return slot >= 0 ? brick_texel(slot, 0) + (voxel & 3) : ivec3(-1);
}

// Node of a word of nodes whose bit this is: occupancy_bit backwards.
ivec3 node_of_bit(ivec3 word, int bit) {
    return word * ivec3(4, 4, 2) +
           ivec3((bit & 1) | (bit >> 3 & 1) << 1, (bit >> 1 & 1) | (bit >> 4 & 1) << 1, bit >> 2 & 1);
}
