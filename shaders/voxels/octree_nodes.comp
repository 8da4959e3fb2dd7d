// Which nodes of one level exist (voxels/octree.glsl), a word of them a thread, and how many nodes and voxels that is.
#include "voxels/octree.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    int level;
    int first_word;  // of the level, in the buffers
} push;

layout(binding = 0) uniform usampler3D occupancy;  // all levels; that of level + 2 has a voxel per node
layout(binding = 1, std430) writeonly buffer NodeBits { uint data[]; } node_bits;
layout(binding = 2, std430) writeonly buffer Counts { uvec2 data[]; } counts;  // nodes; occupied voxels of level 0

uint word_at(ivec3 word, int level) {
    bool inside = all(lessThan(word, textureSize(occupancy, level)));
    return inside ? texelFetch(occupancy, word, level).r : 0u;
}

// Every bit or the next one along an axis, whose word follows.
uint spread_x(uint word, uint next) {
    return word | (word >> 1 & 0x55555555u) | (word >> 7 & 0x00aa00aau) | (next & 0x00550055u) << 9;
}
uint spread_y(uint word, uint next) {
    return word | (word >> 2 & 0x33333333u) | (word >> 14 & 0x0000ccccu) | (next & 0x00003333u) << 18;
}
uint spread_z(uint word, uint next) { return word | (word >> 4 & 0x0f0f0f0fu) | (next & 0x0f0f0f0fu) << 4; }

uint spread_along_x(ivec3 word) {
    return spread_x(word_at(word, push.level + 2), word_at(word + ivec3(1, 0, 0), push.level + 2));
}
uint spread_along_xy(ivec3 word) { return spread_y(spread_along_x(word), spread_along_x(word + ivec3(0, 1, 0))); }

// Whether any voxel that follows the node on a far side is occupied.
bool borders(ivec3 node) {
    uint found = 0u;
    for (int side = 1; side < 8; ++side) {
        ivec3 offset = ivec3(side) >> ivec3(0, 1, 2) & 1;
        // The neighbour's voxels that touch the node.
        uint touching = (offset.x == 1 ? 0x00550055u : ~0u) & (offset.y == 1 ? 0x00003333u : ~0u);
        ivec3 low = (node + offset) * ivec3(1, 1, 2);
        found |= word_at(low, push.level) & touching & (offset.z == 1 ? 0x0f0f0f0fu : ~0u);
        if (offset.z == 0) found |= word_at(low + ivec3(0, 0, 1), push.level) & touching;
    }
    return found != 0u;
}

void main() {
    ivec3 word = ivec3(gl_GlobalInvocationID);
    ivec3 size = textureSize(occupancy, push.level + 2);
    if (any(greaterThanEqual(word, size))) return;

    uint occupied = word_at(word, push.level + 2);
    uint near = spread_z(spread_along_xy(word), spread_along_xy(word + ivec3(0, 0, 1))) & ~occupied;
    uint bits = occupied;
    for (; near != 0u; near &= near - 1u) {
        int bit = findLSB(near);
        if (borders(node_of_bit(word, bit))) bits |= 1u << bit;
    }
    uint voxels = 0u;
    for (uint rest = push.level == 0 ? occupied : 0u; rest != 0u; rest &= rest - 1u) {
        ivec3 low = node_of_bit(word, findLSB(rest)) * ivec3(1, 1, 2);
        voxels += uint(bitCount(word_at(low, 0)) + bitCount(word_at(low + ivec3(0, 0, 1), 0)));
    }
    int place = push.first_word + (word.z * size.y + word.y) * size.x + word.x;
    node_bits.data[place] = bits;
    counts.data[place] = uvec2(bitCount(bits), voxels);
}
