// What the accumulator holds of a cell, as means over its fragments. The includer defines SUMS, EXCHANGED and FLOATS,
// bindings; the last two are one texel where the range does not use them.
#include "voxels/accumulator.glsl"

layout(binding = SUMS, r32ui) readonly uniform uimage3D sums;
layout(binding = EXCHANGED, r32ui) readonly uniform uimage3D exchanged;
layout(binding = FLOATS, r32ui) readonly uniform uimage3D floats;

float sum(ivec3 cell, int word) { return float(imageLoad(sums, sum_texel(cell, word)).r); }

// Mean of three words of 8-bit values, 0 to 1.
vec3 mean_color(ivec3 cell, int word, float weight) {
    return vec3(sum(cell, word), sum(cell, word + 1), sum(cell, word + 2)) / (weight * 255.0);
}

float wide_sum(ivec3 cell, int word) {
    return ldexp(sum(cell, word), -fixed_bits) + ldexp(sum(cell, word + 1), 32 - fixed_bits);
}

// Base colour, or emission in units of its scale. `weight`: the cell's, more than 0.
vec3 mean_value(ivec3 cell, float weight) {
    if (wide_words) {
        return vec3(wide_sum(cell, word_value), wide_sum(cell, word_value + 2), wide_sum(cell, word_value + 4)) / weight;
    }
    if (range == range_ldr || range == range_fixed) return mean_color(cell, word_value, weight);
    if (range == range_average) return average_of(imageLoad(exchanged, cell).r);
    if (range == range_rgbe) return value_of_rgbe(imageLoad(exchanged, cell).r) / weight;
    vec4 locked;
    for (int i = 0; i < 4; ++i) locked[i] = uintBitsToFloat(imageLoad(floats, float_texel(cell, i)).r);
    return locked.rgb / max(locked.a, 1.0);
}
