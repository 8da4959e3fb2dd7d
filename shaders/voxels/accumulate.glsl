// Additions to the accumulator of voxels/accumulator.glsl. The includer defines SUMS, its binding.
#include "voxels/accumulator.glsl"

layout(binding = SUMS, r32ui) uniform uimage3D sums;

void add(ivec3 cell, int word, float value) {
    uint quantised = uint(value + 0.5);
    if (quantised != 0u) imageAtomicAdd(sums, sum_texel(cell, word), quantised);
}

void add_color(ivec3 cell, int first_word, vec3 color, float weight) {
    vec3 bits = floor(clamp(color, 0.0, 1.0) * 255.0 + 0.5);
    add(cell, first_word, bits.r * weight);
    add(cell, first_word + 1, bits.g * weight);
    add(cell, first_word + 2, bits.b * weight);
}
