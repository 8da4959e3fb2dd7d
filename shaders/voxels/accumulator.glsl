// Sums per voxel, and how the values that it holds are summed.
//
// The accumulator is an r32_uint volume with sum_words texels along x per cell: the weight, which is the fragments' share
// of surface area; base colour or emission, as the range has it; where asked for, the components of the normal, as
// colours; and the weight times opacity. All are integers added atomically, which come out the same in any order. A word
// holds 2^32 / (255 * 64), about 263 000, fragments of full weight.
//
// Values (voxels::Range):
//   - ldr: red, green and blue of 8 bits, held to 1, times the weight.
//   - fixed: base colour likewise; emission times the weight in fixed point of 64 bits, a low and a high word for red, for
//     green and for blue. 1 is 2^fixed_bits, and a word's carries are counted, so nothing is rounded but what is added.
// The others exchange a word of a second volume, and depend on the order:
//   - average: a running mean of 8 bits and the count of fragments, up to 255 (Crassin & Green 2012).
//   - rgbe: the weighted sum as three mantissas of 8 bits and their exponent (Ward 1991).
//   - mutex: a lock; whoever holds it adds the weighted value, and the weight, to four floats of a third volume, a texel
//     each along x.

layout(constant_id = 1) const bool emission = false;     // values are emission instead of base colour
layout(constant_id = 2) const bool translucent = false;  // some surface is blended
layout(constant_id = 3) const bool normals = false;      // light is reflected on from voxel to voxel
layout(constant_id = 4) const int range = 0;

const int range_ldr = 0;
const int range_average = 1;
const int range_mutex = 2;
const int range_rgbe = 3;
const int range_fixed = 4;

const bool wide_words = range == range_fixed && emission;
const int value_words = range == range_ldr || range == range_fixed ? (wide_words ? 6 : 3) : 0;

const int word_weight = 0;
const int word_value = 1;
const int word_normal = word_value + value_words;
const int word_opacity = word_normal + (normals ? 3 : 0);
const int sum_words = word_opacity + (translucent ? 1 : 0);

const float weight_unit = 64.0;
// A fragment of full weight takes up to 12 bits of the high word, which so holds a million of them.
const int fixed_bits = 38;

ivec3 sum_texel(ivec3 cell, int word) {
    return ivec3(cell.x * sum_words + word, cell.yz);
}

ivec3 float_texel(ivec3 cell, int component) { return ivec3(cell.x * 4 + component, cell.yz); }

// Of a voxel's fragments a word of 8 bits a colour.
vec3 average_of(uint word) { return vec3(word & 255u, word >> 8 & 255u, word >> 16 & 255u) / 255.0; }

vec3 value_of_rgbe(uint word) {
    return vec3(word & 255u, word >> 8 & 255u, word >> 16 & 255u) * exp2(float(word >> 24) - 136.0);
}

// `rounding`, 0 to 1, is where between two steps a number goes up.
uint rgbe_of_value(vec3 value, float rounding) {
    float largest = max(value.r, max(value.g, value.b));
    // frexp by the bits: a power of two that is greater than the largest, from 2^-126 on.
    int exponent = max((floatBitsToInt(largest) >> 23) - 126, -126);
    if (floor(largest * exp2(float(8 - exponent)) + rounding) > 255.0) ++exponent;
    uvec3 mantissas = uvec3(floor(value * exp2(float(8 - exponent)) + rounding));
    return largest > 0.0 ? mantissas.r | mantissas.g << 8 | mantissas.b << 16 | uint(exponent + 128) << 24 : 0u;
}
