// Texels on the CPU: what each format's bytes mean, by the formats' definitions in the Vulkan and OpenGL
// specifications.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "rhi/format.hpp"

namespace lumo::testing_support {

using Color = std::array<double, 4>;

/// An unsigned or signed small float with `mantissa` bits of fraction and 5 of exponent.
inline double decode_small_float(uint32_t bits, int mantissa) {
    const uint32_t exponent = bits >> mantissa & 31;
    const double fraction = double(bits & ((1u << mantissa) - 1)) / double(1u << mantissa);
    const double value =
        exponent == 0 ? std::ldexp(fraction, -14) : std::ldexp(1 + fraction, int(exponent) - 15);
    return bits >> (mantissa + 5) & 1 ? -value : value;
}

inline double decode_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// One texel as a shader reads it: missing channels are 0, missing alpha is 1. Not for blocks.
inline Color decode(rhi::Format format, const std::byte* bytes) {
    using enum rhi::Format;
    const auto at = [&]<class T>(T, int i) {
        T value;
        std::memcpy(&value, bytes + i * int(sizeof(T)), sizeof(T));
        return value;
    };
    const auto u8 = [&](int i) { return double(at(uint8_t{}, i)); };
    const auto u16 = [&](int i) { return at(uint16_t{}, i); };
    const auto u32 = [&](int i) { return at(uint32_t{}, i); };
    const auto half = [&](int i) { return decode_small_float(u16(i), 10); };
    const auto f32 = [&](int i) { return double(at(float{}, i)); };
    switch (format) {
        case r8_unorm:
            return {u8(0) / 255, 0, 0, 1};
        case rg8_unorm:
            return {u8(0) / 255, u8(1) / 255, 0, 1};
        case rgba8_unorm:
            return {u8(0) / 255, u8(1) / 255, u8(2) / 255, u8(3) / 255};
        case rgba8_srgb:
            return {decode_srgb(u8(0) / 255), decode_srgb(u8(1) / 255), decode_srgb(u8(2) / 255),
                    u8(3) / 255};
        case rgba8_uint:
            return {u8(0), u8(1), u8(2), u8(3)};
        case rgb10a2_unorm: {
            const uint32_t w = u32(0);
            return {(w & 1023) / 1023.0, (w >> 10 & 1023) / 1023.0, (w >> 20 & 1023) / 1023.0,
                    (w >> 30) / 3.0};
        }
        case r11g11b10_float: {
            const uint32_t w = u32(0);
            return {decode_small_float(w & 2047, 6), decode_small_float(w >> 11 & 2047, 6),
                    decode_small_float(w >> 22, 5), 1};
        }
        case r16_uint:
            return {double(u16(0)), 0, 0, 1};
        case r16_float:
            return {half(0), 0, 0, 1};
        case rg16_float:
            return {half(0), half(1), 0, 1};
        case rgba16_float:
            return {half(0), half(1), half(2), half(3)};
        case rgba16_unorm:
            return {u16(0) / 65535.0, u16(1) / 65535.0, u16(2) / 65535.0, u16(3) / 65535.0};
        case r32_uint:
            return {double(u32(0)), 0, 0, 1};
        case r32_sint:
            return {double(at(int32_t{}, 0)), 0, 0, 1};
        case r32_float:
        case d32_float:
            return {f32(0), 0, 0, 1};
        case rg32_uint:
            return {double(u32(0)), double(u32(1)), 0, 1};
        case rg32_float:
            return {f32(0), f32(1), 0, 1};
        case rgba32_uint:
            return {double(u32(0)), double(u32(1)), double(u32(2)), double(u32(3))};
        case rgba32_float:
            return {f32(0), f32(1), f32(2), f32(3)};
        default:
            return {};
    }
}

/// Random bytes that are finite numbers in every format: floats stay within [-2, 2], depth within [0, 1].
inline std::vector<std::byte> random_texels(rhi::Format format, size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    const rhi::FormatInfo& info = rhi::format_info(format);
    std::vector<std::byte> bytes(count * info.bytes_per_block);
    for (std::byte& byte : bytes) byte = std::byte(random());
    const bool half = format == rhi::Format::r16_float || format == rhi::Format::rg16_float ||
                      format == rhi::Format::rgba16_float;
    if (half) {
        for (size_t i = 0; i < bytes.size(); i += 2) {
            const auto value = uint16_t(random() % 0x4000 | (random() & 1) << 15);
            std::memcpy(&bytes[i], &value, 2);
        }
    } else if (format == rhi::Format::r11g11b10_float) {
        for (size_t i = 0; i < bytes.size(); i += 4) {
            const uint32_t value = random() % 1024 | random() % 1024 << 11 | random() % 512 << 22;
            std::memcpy(&bytes[i], &value, 4);
        }
    } else if (info.kind == rhi::FormatKind::floating && info.block_side == 1) {
        std::uniform_real_distribution<float> range(-2, 2);
        for (size_t i = 0; i < bytes.size(); i += 4) {
            const float value = range(random);
            std::memcpy(&bytes[i], &value, 4);
        }
    } else if (info.kind == rhi::FormatKind::depth) {
        std::uniform_real_distribution<float> range(0, 1);
        for (size_t i = 0; i < bytes.size(); i += 4) {
            const float value = range(random);
            std::memcpy(&bytes[i], &value, 4);
        }
    }
    return bytes;
}

}  // namespace lumo::testing_support
