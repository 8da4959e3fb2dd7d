// Texel formats: the ones that both APIs have, under one name.
#pragma once

#include <cstdint>
#include <string_view>

#include "rhi/flags.hpp"

namespace lumo::rhi {

enum class Format : uint8_t {
    undefined,
    r8_unorm,
    rg8_unorm,
    rgba8_unorm,
    rgba8_srgb,
    rgba8_uint,
    rgb10a2_unorm,
    r11g11b10_float,
    r16_uint,
    r16_float,
    rg16_float,
    rgba16_float,
    rgba16_unorm,
    r32_uint,
    r32_sint,
    r32_float,
    rg32_uint,
    rg32_float,
    rgba32_uint,
    rgba32_float,
    d32_float,
    bc1_rgba_srgb,
    bc3_rgba_srgb,
    bc4_r_unorm,
    bc5_rg_unorm,
    bc6h_rgb_float,
    bc7_rgba_unorm,
    bc7_rgba_srgb,
};
inline constexpr int format_count = int(Format::bc7_rgba_srgb) + 1;

enum class FormatKind : uint8_t { unorm, srgb, floating, uint, sint, depth };

struct FormatInfo {
    std::string_view name;  ///< as the enumerator
    FormatKind kind;
    uint8_t channels;
    uint8_t bytes_per_block;
    uint8_t block_side;  ///< texels; 4 for the BC formats, else 1
};

const FormatInfo& format_info(Format format);

/// What a device can do with a format.
enum class FormatCaps : uint8_t {
    none = 0,
    sampled = 1,
    linear_filter = 2,
    storage = 4,
    storage_atomic = 8,
    attachment = 16,  ///< colour or depth
    blend = 32,
    multisample = 64,
};
template <>
inline constexpr bool is_flags<FormatCaps> = true;

}  // namespace lumo::rhi
