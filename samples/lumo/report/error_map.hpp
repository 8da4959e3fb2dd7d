// Where a picture's light is wrong, as a picture.
#pragma once

#include <array>
#include <cstdint>

#include "reference/metrics.hpp"
#include "rhi/error.hpp"
#include "scene/image.hpp"

namespace lumo::program {

/// The colour of a difference from -1 (blue) through 0 (white) to 1 (red), sRGB; beyond is clamped.
std::array<uint8_t, 3> signed_color(double value);

/// A difference of this part of the reference's mean has the strongest colour.
inline constexpr double error_map_range = 0.5;

/// (test - reference) / mean of the reference, of the 4 x 4-block means that reference::relative_rmse is made of, mean over
/// the colours; RGB, as large as the pictures. What is not kept is grey. Errors: invalid_argument (sizes that differ).
Result<scene::Image8> error_map(const scene::ImageF& reference, const scene::ImageF& test,
                                reference::Mask keep);

/// Linear radiance at an exposure in stops, tone-mapped as reference::tone_mapped and sRGB-encoded, RGB.
scene::Image8 displayed(const scene::ImageF& radiance, double stops);

}  // namespace lumo::program
