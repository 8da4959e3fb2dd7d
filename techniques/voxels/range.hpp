// What range of values voxels hold, and how fragments are summed to it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lumo::voxels {

/// By how base colours and emission are summed (shaders/voxels/accumulator.glsl), and what light is stored in:
///   - ldr: 8 bits. Sums of integers, the same in any order; emission above 1 W/m²/sr counts as 1.
///   - average: 8 bits. The paper's running mean with a count, in one word by compare-and-swap.
///   - mutex: half floats. The paper's lock per voxel around four floats; what finds no way in is dropped and counted.
///   - rgbe: half floats. Ward's shared exponent, in one word by compare-and-swap; dropped only after 65 535 tries.
///   - fixed: half floats. Sums of integers, of 64 bits for emission, in units of the scene's highest emission.
enum class Range : uint8_t { ldr, average, mutex, rgbe, fixed };

inline constexpr std::array all_ranges{Range::ldr, Range::average, Range::mutex, Range::rgbe, Range::fixed};

constexpr std::string_view to_string(Range range) {
    constexpr std::array<std::string_view, all_ranges.size()> names{"ldr", "average", "mutex", "rgbe",
                                                                    "fixed"};
    return names[size_t(range)];
}

/// Light is stored in half floats instead of 8 bits.
constexpr bool is_wide(Range range) { return range >= Range::mutex; }

/// Sums come out the same in any order, and so on both APIs.
constexpr bool is_order_free(Range range) { return range == Range::ldr || range == Range::fixed; }

}  // namespace lumo::voxels
