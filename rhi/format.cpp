#include "rhi/format.hpp"

#include <array>

namespace lumo::rhi {

const FormatInfo& format_info(Format format) {
    using enum FormatKind;
    static constexpr std::array<FormatInfo, format_count> table{{
        {"undefined", unorm, 0, 0, 1},       {"r8_unorm", unorm, 1, 1, 1},
        {"rg8_unorm", unorm, 2, 2, 1},       {"rgba8_unorm", unorm, 4, 4, 1},
        {"rgba8_srgb", srgb, 4, 4, 1},       {"rgba8_uint", uint, 4, 4, 1},
        {"rgb10a2_unorm", unorm, 4, 4, 1},   {"r11g11b10_float", floating, 3, 4, 1},
        {"r16_uint", uint, 1, 2, 1},         {"r16_float", floating, 1, 2, 1},
        {"rg16_float", floating, 2, 4, 1},   {"rgba16_float", floating, 4, 8, 1},
        {"rgba16_unorm", unorm, 4, 8, 1},    {"r32_uint", uint, 1, 4, 1},
        {"r32_sint", sint, 1, 4, 1},         {"r32_float", floating, 1, 4, 1},
        {"rg32_uint", uint, 2, 8, 1},        {"rg32_float", floating, 2, 8, 1},
        {"rgba32_uint", uint, 4, 16, 1},     {"rgba32_float", floating, 4, 16, 1},
        {"d32_float", depth, 1, 4, 1},       {"bc1_rgba_srgb", srgb, 4, 8, 4},
        {"bc3_rgba_srgb", srgb, 4, 16, 4},   {"bc4_r_unorm", unorm, 1, 8, 4},
        {"bc5_rg_unorm", unorm, 2, 16, 4},   {"bc6h_rgb_float", floating, 3, 16, 4},
        {"bc7_rgba_unorm", unorm, 4, 16, 4}, {"bc7_rgba_srgb", srgb, 4, 16, 4},
    }};
    return table[size_t(format)];
}

}  // namespace lumo::rhi
