// Occupancy of the next coarser level: a voxel is occupied if any of its eight children is.
#include "voxels/occupancy.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) readonly uniform uimage3D finer;
layout(binding = 1, r32ui) writeonly uniform uimage3D coarser;

// A bit per byte, lowest first.
uint bytes_with_bits(uint word) {
    word |= word >> 4;
    word |= word >> 2;
    word |= word >> 1;
    word &= 0x01010101u;
    return (word | word >> 7 | word >> 14 | word >> 21) & 0xfu;
}

void main() {
    ivec3 word = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(word, imageSize(coarser)))) return;

    uint bits = 0u;
    for (int child = 0; child < 8; ++child) {
        ivec3 part = ivec3(child) >> ivec3(0, 1, 2) & 1;
        ivec3 place = word * 2 + part;
        if (all(lessThan(place, imageSize(finer)))) {
            bits |= bytes_with_bits(imageLoad(finer, place).r) << (8 * part.x + 16 * part.y + 4 * part.z);
        }
    }
    imageStore(coarser, word, uvec4(bits));
}
