// Additions to the accumulator of voxels/accumulator.glsl. The includer defines SUMS, its binding; and for the ranges that
// exchange words EXCHANGED, FLOATS and DROPPED, the bindings of the second volume, the third, and a counter.
#include "voxels/accumulator.glsl"

layout(binding = SUMS, r32ui) uniform uimage3D sums;

// What was added is taken away exactly: integers wrap.
uint signed_amount(uint amount) { return push.subtract != 0u ? 0u - amount : amount; }

void add(ivec3 cell, int word, float value) {
    uint quantised = uint(value + 0.5);
    if (quantised != 0u) imageAtomicAdd(sums, sum_texel(cell, word), signed_amount(quantised));
}

void add_color(ivec3 cell, int first_word, vec3 color, float weight) {
    vec3 bits = floor(clamp(color, 0.0, 1.0) * 255.0 + 0.5);
    add(cell, first_word, bits.r * weight);
    add(cell, first_word + 1, bits.g * weight);
    add(cell, first_word + 2, bits.b * weight);
}

#ifdef EXCHANGED
layout(binding = EXCHANGED, r32ui) coherent LUMO_READ_WRITE uniform uimage3D exchanged;
layout(binding = FLOATS, r32ui) coherent LUMO_READ_WRITE uniform uimage3D floats;
layout(binding = DROPPED, std430) buffer Dropped {
    uint writes;
} dropped;

// Tries of what may wait for others without end.
const int max_tries = 1024;
// Whoever fails to exchange a word was overtaken by another who did. So no more tries are needed than there are
// fragments in flight for one voxel; this is where drivers end loops.
const int max_overtaken = 65535;

uint hash(uint x) {
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}

bool add_average(ivec3 cell, vec3 value) {
    vec3 added = clamp(value, 0.0, 1.0) * 255.0;
    bool done = false;
    uint expected = 0u;
    for (int i = 0; i < max_tries && !done; ++i) {
        float count = float(expected >> 24);
        uvec3 mean = uvec3((average_of(expected) * 255.0 * count + added) / (count + 1.0) + 0.5);
        uint next = mean.r | mean.g << 8 | mean.b << 16 | uint(min(count + 1.0, 255.0)) << 24;
        uint found = imageAtomicCompSwap(exchanged, cell, expected, next);
        done = found == expected;
        expected = found;
    }
    return done;
}

bool add_rgbe(ivec3 cell, vec3 value, uint seed) {
    bool done = false;
    uint expected = 0u;
    for (int i = 0; i < max_overtaken && !done; ++i) {
        // Rounded up as often as the rest is large: what is less than a step of the sum would be lost each time else.
        float rounding = float(hash(seed ^ expected) >> 8) / 16777216.0;
        uint next = rgbe_of_value(value_of_rgbe(expected) + value, rounding);
        uint found = imageAtomicCompSwap(exchanged, cell, expected, next);
        done = found == expected;
        expected = found;
    }
    return done;
}

bool add_locked(ivec3 cell, vec4 value) {
    bool done = false;
    for (int tries = 0; tries < max_tries && !done; ++tries) {
        if (imageAtomicExchange(exchanged, cell, 1u) == 0u) {
            // Atomics here too: what plain loads see of another's stores is not the same on every driver.
            for (int i = 0; i < 4; ++i) {
                float before = uintBitsToFloat(imageAtomicOr(floats, float_texel(cell, i), 0u));
                imageAtomicExchange(floats, float_texel(cell, i), floatBitsToUint(before + value[i]));
            }
            imageAtomicExchange(exchanged, cell, 0u);
            done = true;
        }
    }
    return done;
}

void add_value(ivec3 cell, vec3 value, float weight, uint seed) {
    bool done = range == range_average ? add_average(cell, value)
                : range == range_rgbe  ? add_rgbe(cell, value * weight, seed)
                                       : add_locked(cell, vec4(value, 1) * weight);
    if (!done) atomicAdd(dropped.writes, 1u);
}
#else
void add_wide(ivec3 cell, int first_word, float value) {
    // Exact but for the last step: what is left of a float below a power of two is a float.
    float scaled = ldexp(value, fixed_bits - 32);
    float whole = floor(scaled);
    uint low = uint((scaled - whole) * 4294967296.0);
    uint high = uint(whole);
    if (low != 0u) {
        uint before = imageAtomicAdd(sums, sum_texel(cell, first_word), signed_amount(low));
        if (push.subtract != 0u ? before < low : before + low < before) ++high;
    }
    if (high != 0u) imageAtomicAdd(sums, sum_texel(cell, first_word + 1), signed_amount(high));
}

void add_value(ivec3 cell, vec3 value, float weight, uint seed) {
    if (wide_words) {
        for (int i = 0; i < 3; ++i) add_wide(cell, word_value + 2 * i, max(value[i], 0.0) * weight);
    } else {
        add_color(cell, word_value, value, weight);
    }
}
#endif
