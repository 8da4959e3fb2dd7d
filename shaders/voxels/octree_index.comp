// Ranks for one level's nodes, and for level 0 the places of its voxels in the list.
#include "voxels/octree.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(constant_id = 0) const bool list_voxels = false;

layout(push_constant) uniform Push {
    int level;
    int first_word;       // of the level, in the buffers
    int first_fine_word;  // of level 0
    int block;            // of the prefix sums
    int most_nodes;       // of the level's pool
    int most_voxels;
} push;

layout(binding = 0, std430) readonly buffer NodeBits { uint data[]; } node_bits;
layout(binding = 1, std430) readonly buffer Counts { uvec2 data[]; } counts;  // prefix sums in each block
layout(binding = 2, std430) readonly buffer Totals { uvec2 data[]; } totals;  // prefix sums of the blocks' totals
layout(binding = 3) uniform usampler3D occupancy;
layout(binding = 4, rg32ui) writeonly uniform uimage3D nodes;
layout(binding = 5, std430) writeonly buffer Records { uint data[]; } records;  // of three words
layout(binding = 6, std430) writeonly buffer Voxels { uint data[]; } voxels;    // 10 bits for each of x, y and z

uvec2 before(int place) { return counts.data[place] + totals.data[place / push.block]; }

// Lists the voxels of half a node. Returns the place for the next one.
uint list_half(uint bits, ivec3 word, uint place) {
    for (; bits != 0u; bits &= bits - 1u) {
        uvec3 voxel = uvec3(node_of_bit(word, findLSB(bits)));
        voxels.data[place++] = voxel.x | voxel.y << 10 | voxel.z << 20;
    }
    return place;
}

void main() {
    ivec3 word = ivec3(gl_GlobalInvocationID);
    ivec3 size = imageSize(nodes);
    if (any(greaterThanEqual(word, size))) return;

    int place = push.first_word + (word.z * size.y + word.y) * size.x + word.x;
    uint bits = node_bits.data[place];
    uvec2 first = before(place);
    // Level 0 has a pool of its own; in the other one the three single nodes come first.
    int rank = push.level == 0 ? int(first.x - before(push.first_fine_word).x) : int(first.x) + 3;

    // What was not counted when the pools were made is left out: the last nodes, never one between others.
    uint kept = 0u;
    int slot = rank;
    uint voxel = first.y;
    for (uint rest = bits; rest != 0u && slot < push.most_nodes; rest &= rest - 1u) {
        int bit = findLSB(rest);
        if (push.level == 0) {
            ivec3 low = node_of_bit(word, bit) * ivec3(1, 1, 2);
            uvec2 mask = uvec2(texelFetch(occupancy, low, 0).r, texelFetch(occupancy, low + ivec3(0, 0, 1), 0).r);
            uint next = voxel + uint(bitCount(mask.x) + bitCount(mask.y));
            if (next > uint(push.most_voxels)) break;
            records.data[3 * slot] = mask.x;
            records.data[3 * slot + 1] = mask.y;
            records.data[3 * slot + 2] = voxel;
            if (list_voxels) list_half(mask.y, low + ivec3(0, 0, 1), list_half(mask.x, low, voxel));
            voxel = next;
        }
        kept |= 1u << bit;
        ++slot;
    }
    imageStore(nodes, word, uvec4(kept, rank, 0, 0));
}
