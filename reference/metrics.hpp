// How far one picture is from another.
//
// Both pictures have the same size and number of channels, 1 to 4; anything else is an invalid_argument. The
// figures are over the colour: the first three channels, or all of one or two; a fourth is alpha and counts
// in the parity alone. A value that is not finite is never left out: it makes the figure NaN or infinite.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scene/image.hpp"

namespace lumo::reference {

/// Which pixels count: width * height values by rows from the top, 0 leaves a pixel out. Empty keeps all. One
/// that has another size or keeps nothing is an invalid_argument.
using Mask = std::span<const uint8_t>;

/// Keeps the pixels whose emission is zero in every channel, so that visible emitters and the sky, which
/// reach the camera without a surface reflecting them, are left out.
Result<std::vector<uint8_t>> mask_of_reflectors(const scene::ImageF& emission);

/// Mean over the pixels kept and the colour channels.
Result<double> mean(const scene::ImageF& image, Mask keep = {});

/// Root mean square of the difference of 4×4-block means over the mean magnitude of the reference, which is
/// its mean for radiance. Blocks start at the top left; a block's mean is over those of its pixels that lie
/// in the picture and are kept, and it weighs as many as they are. Zero when both are black, infinite when
/// only the reference is.
Result<double> relative_rmse(const scene::ImageF& reference, const scene::ImageF& test, Mask keep = {});

/// Mean of the test over the mean of the reference, minus 1; 0 when both are zero.
Result<double> bias(const scene::ImageF& reference, const scene::ImageF& test, Mask keep = {});

/// The 95th percentile (nearest rank) of the relative difference of blocks. Over the same 4×4-block means,
/// each block once whatever it weighs: the length of the colour difference over the length of the reference's
/// colour, but at least 1 % of its mean length over the blocks, so that noise in black corners does not rule.
/// NaN if any value is not finite.
Result<double> percentile95_relative(const scene::ImageF& reference, const scene::ImageF& test,
                                     Mask keep = {});

/// The exposure, in stops, that brings the log-average luminance of the pixels kept to 0.18 (Reinhard et al.
/// 2002, "Photographic tone reproduction for digital images", equations 1 and 2); black pixels and those that
/// are not finite are left out; 0 when nothing remains.
Result<double> automatic_exposure(const scene::ImageF& radiance, Mask keep = {});

/// Linear radiance to linear display-referred RGB in [0, 1]: luminance L is scaled by 2^stops and compressed
/// to L / (1 + L) (Reinhard et al. 2002, equation 3) with the hue kept, then each channel is clamped. Fewer
/// than three channels are a grey made of the first.
scene::ImageF tone_mapped(const scene::ImageF& radiance, double stops);

/// sRGB-encoded RGB, as an 8-bit picture over 255 holds it, to linear display-referred RGB. Fewer than three
/// channels are a grey made of the first.
scene::ImageF decoded_srgb(const scene::ImageF& encoded);

/// Pixels per degree of a 0.7 m wide screen of 3840 pixels seen from 0.7 m: ꟻLIP's default.
inline constexpr double default_pixels_per_degree = 67.0206;

/// ꟻLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", the LDR metric): how
/// visible the difference is when the two pictures are flipped in place, per pixel, 0 (not) to 1. Both are
/// linear display-referred RGB of at least three channels; values outside [0, 1] are clamped. One channel
/// comes back.
Result<scene::ImageF> flip(const scene::ImageF& reference, const scene::ImageF& test,
                           double pixels_per_degree = default_pixels_per_degree);

/// Two pictures of one frame agree where, in each channel, |a − b| ≤ max(absolute, relative · max(|a|, |b|,
/// m)), and as a whole when this fraction of the pixels does. m is the mean magnitude of the finite colours
/// of a picture, the lesser of the two.
struct ParityRule {
    double relative = 0;
    double absolute = 0;
    double fraction = 1;
};

/// One step of an 8-bit picture over 255, and what float32 makes of the difference of two such numbers.
inline constexpr double one_step_of_255 = (1 + 1e-4) / 255;

inline constexpr ParityRule mesa_parity{.relative = 1e-4, .fraction = 0.9999};
inline constexpr ParityRule hardware_parity{.relative = 1e-3, .fraction = 0.999};
inline constexpr ParityRule mesa_png_parity{.absolute = one_step_of_255, .fraction = 0.9999};
inline constexpr ParityRule hardware_png_parity{.absolute = one_step_of_255, .fraction = 0.999};

/// A channel of a pixel that breaks a parity rule.
struct ParityMiss {
    uint32_t x = 0;  ///< from the left
    uint32_t y = 0;  ///< from the top
    uint32_t channel = 0;
    float a = 0;
    float b = 0;
    double times_bound = 0;  ///< the difference over what the rule allows; infinite where one is not finite
};

struct Parity {
    ParityRule rule = {};
    uint64_t pixels = 0;
    uint64_t pixels_identical = 0;        ///< equal in every channel
    uint64_t pixels_beyond = 0;           ///< with at least one channel beyond the rule
    double mean_magnitude = 0;            ///< m of the rule
    double worst_difference = 0;          ///< greatest |a − b| of finite values
    double worst_times_bound = 0;         ///< greatest ParityMiss::times_bound, also of what keeps the rule
    std::vector<ParityMiss> misses = {};  ///< the worst first, at most as many as asked for
    bool passed = false;
};

/// Compares every pixel and channel. Not a number equals not a number, and an infinity its like; any other
/// pair with a value that is not finite is beyond.
Result<Parity> parity(const scene::ImageF& a, const scene::ImageF& b, const ParityRule& rule,
                      size_t max_misses = 1000);

/// A picture of where two pictures differ: RGB in [0, 1], display-referred, to be written without tone
/// mapping. Per pixel the greatest |a − b| / max(|a|, |b|, m) over the channels, m as in ParityRule, on a
/// logarithmic scale whose brightness rises from `lowest` (navy) to `highest` (pale yellow), clamped. Black
/// where equal; pure green where one is not finite.
Result<scene::ImageF> difference_picture(const scene::ImageF& a, const scene::ImageF& b, double lowest = 1e-6,
                                         double highest = 1);

struct CompareOptions {
    Mask keep = {};  ///< for all but the parity, which is over every pixel
    ParityRule parity_rule = mesa_parity;
    size_t max_misses = 1000;
    bool encoded_srgb = false;  ///< the pictures are sRGB-encoded, 0 to 1, rather than linear radiance
    /// Stops, for ꟻLIP of radiance; none: automatic_exposure of the reference.
    std::optional<double> exposure = std::nullopt;
    double pixels_per_degree = default_pixels_per_degree;
};

/// All figures of two pictures.
struct Comparison {
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t channels = 0;
    uint64_t pixels_kept = 0;
    uint64_t not_finite_reference = 0;  ///< values, of all pixels and channels
    uint64_t not_finite_test = 0;
    double mean_reference = 0;
    double mean_test = 0;
    double relative_rmse = 0;
    double bias = 0;
    double percentile95_relative = 0;
    /// Stops, at which ꟻLIP was measured; none for encoded pictures.
    std::optional<double> exposure = std::nullopt;
    double flip_mean = 0;  ///< mean of ꟻLIP over the pixels kept
    Parity parity = {};
};

Result<Comparison> compare(const scene::ImageF& reference, const scene::ImageF& test,
                           const CompareOptions& options = {});

}  // namespace lumo::reference
