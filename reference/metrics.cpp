#include "reference/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <glm/glm.hpp>
#include <limits>
#include <tuple>

namespace lumo::reference {
namespace {

using scene::ImageF;

constexpr uint32_t block_side = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

Result<void> check_image(const ImageF& image) {
    if (image.channels < 1 || image.channels > 4) {
        return fail(ErrorKind::invalid_argument, "picture", fmt::format("{} channels", image.channels),
                    "1 to 4 can be compared");
    }
    const size_t expected = size_t(image.width) * image.height * image.channels;
    if (expected == 0 || image.values.size() != expected) {
        return fail(ErrorKind::invalid_argument, "picture",
                    fmt::format("{}x{} pixels of {} channels, but {} values", image.width, image.height,
                                image.channels, image.values.size()));
    }
    return {};
}

Result<void> check_mask(const ImageF& image, Mask keep) {
    if (keep.empty()) return {};
    if (keep.size() != size_t(image.width) * image.height) {
        return fail(ErrorKind::invalid_argument, "mask",
                    fmt::format("{} values for {}x{} pixels", keep.size(), image.width, image.height));
    }
    if (std::ranges::all_of(keep, [](uint8_t k) { return k == 0; })) {
        return fail(ErrorKind::invalid_argument, "mask", "keeps no pixel");
    }
    return {};
}

Result<void> check_pair(const ImageF& a, const ImageF& b) {
    return check_image(a).and_then([&] { return check_image(b); }).and_then([&]() -> Result<void> {
        if (a.width == b.width && a.height == b.height && a.channels == b.channels) return {};
        return fail(ErrorKind::invalid_argument, "pictures",
                    fmt::format("{}x{} with {} channels against {}x{} with {}", a.width, a.height, a.channels,
                                b.width, b.height, b.channels),
                    "compare pictures of the same size and channels");
    });
}

Result<void> check(const ImageF& reference, const ImageF& test, Mask keep) {
    return check_pair(reference, test).and_then([&] { return check_mask(reference, keep); });
}

uint32_t color_channels(const ImageF& image) { return std::min(image.channels, 3u); }

bool keeps(Mask keep, const ImageF& image, uint32_t x, uint32_t y) {
    return keep.empty() || keep[size_t(y) * image.width + x] != 0;
}

/// Calls f(x, y) for every pixel that the mask keeps.
template <class F>
void for_each_kept(const ImageF& image, Mask keep, F&& f) {
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            if (keeps(keep, image, x, y)) f(x, y);
        }
    }
}

struct Color {
    std::array<double, 3> sum{};
    double magnitude = 0;  ///< sum of |value| over the channels
};

/// The sums over the pixels that a mask keeps.
struct Totals {
    Color color;
    uint64_t pixels = 0;
};

Totals totals(const ImageF& image, Mask keep) {
    Totals t;
    const uint32_t channels = color_channels(image);
    for_each_kept(image, keep, [&](uint32_t x, uint32_t y) {
        const float* pixel = image.at(x, y);
        ++t.pixels;
        for (uint32_t c = 0; c < channels; ++c) {
            t.color.sum[c] += pixel[c];
            t.color.magnitude += std::abs(double(pixel[c]));
        }
    });
    return t;
}

/// The mean colours of one 4×4 block.
struct Block {
    glm::dvec3 reference{0};
    glm::dvec3 test{0};
    uint32_t pixels = 0;
};

/// The blocks that hold a pixel to be kept.
std::vector<Block> block_means(const ImageF& reference, const ImageF& test, Mask keep) {
    const uint32_t columns = (reference.width + block_side - 1) / block_side;
    const uint32_t rows = (reference.height + block_side - 1) / block_side;
    const auto channels = glm::length_t(color_channels(reference));
    std::vector<Block> blocks(size_t(columns) * rows);
    for_each_kept(reference, keep, [&](uint32_t x, uint32_t y) {
        Block& block = blocks[size_t(y / block_side) * columns + x / block_side];
        ++block.pixels;
        for (glm::length_t c = 0; c < channels; ++c) {
            block.reference[c] += reference.at(x, y)[c];
            block.test[c] += test.at(x, y)[c];
        }
    });
    std::erase_if(blocks, [](const Block& block) { return block.pixels == 0; });
    for (Block& block : blocks) {
        block.reference /= block.pixels;
        block.test /= block.pixels;
    }
    return blocks;
}

/// Zero of nothing is nothing, something of nothing is infinitely much.
double ratio(double numerator, double denominator) {
    if (denominator != 0 || std::isnan(numerator)) return numerator / denominator;
    return numerator == 0 ? 0 : infinity;
}

/// Mean magnitude of a picture's finite colours.
double mean_magnitude(const ImageF& image) {
    double sum = 0;
    uint64_t count = 0;
    for_each_kept(image, {}, [&](uint32_t x, uint32_t y) {
        for (uint32_t c = 0; c < color_channels(image); ++c) {
            const float value = image.at(x, y)[c];
            if (!std::isfinite(value)) continue;
            sum += std::abs(double(value));
            ++count;
        }
    });
    return count == 0 ? 0 : sum / double(count);
}

/// The lesser of both, so that a picture gone wild does not widen its own bounds.
double mean_magnitude(const ImageF& a, const ImageF& b) {
    return std::min(mean_magnitude(a), mean_magnitude(b));
}

bool identical(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

double scale_of(float a, float b, double mean) {
    return std::max({std::abs(double(a)), std::abs(double(b)), mean});
}

double luminance(const float* rgb, uint32_t channels) {
    return channels < 3 ? rgb[0] : 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// Three channels by f(pixel, channel), where a grey repeats the first.
template <class F>
ImageF mapped_rgb(const ImageF& image, F&& f) {
    ImageF out{image.width, image.height, 3, std::vector<float>(size_t(image.width) * image.height * 3)};
    for_each_kept(image, {}, [&](uint32_t x, uint32_t y) {
        for (uint32_t c = 0; c < 3; ++c) {
            out.at(x, y)[c] = float(f(image.at(x, y), image.channels < 3 ? 0 : c));
        }
    });
    return out;
}

/// A ramp of rising brightness: navy, violet, rose, orange, pale yellow.
glm::dvec3 heat(double t) {
    constexpr std::array ramp{glm::dvec3(0.08, 0.08, 0.35), glm::dvec3(0.32, 0.14, 0.58),
                              glm::dvec3(0.80, 0.26, 0.40), glm::dvec3(0.98, 0.66, 0.20),
                              glm::dvec3(1.00, 1.00, 0.85)};
    const double position = std::clamp(t, 0.0, 1.0) * double(ramp.size() - 1);
    const size_t left = std::min(size_t(position), ramp.size() - 2);
    return glm::mix(ramp[left], ramp[left + 1], position - double(left));
}

uint64_t count_not_finite(const ImageF& image) {
    return uint64_t(std::ranges::count_if(image.values, [](float v) { return !std::isfinite(v); }));
}

}  // namespace

Result<std::vector<uint8_t>> mask_of_reflectors(const ImageF& emission) {
    return check_image(emission).map([&] {
        std::vector<uint8_t> keep(size_t(emission.width) * emission.height);
        for_each_kept(emission, {}, [&](uint32_t x, uint32_t y) {
            const std::span pixel(emission.at(x, y), color_channels(emission));
            keep[size_t(y) * emission.width + x] = std::ranges::all_of(pixel, [](float v) { return v == 0; });
        });
        return keep;
    });
}

Result<double> mean(const ImageF& image, Mask keep) {
    return check_image(image).and_then([&] { return check_mask(image, keep); }).map([&] {
        const Totals t = totals(image, keep);
        return (t.color.sum[0] + t.color.sum[1] + t.color.sum[2]) / double(t.pixels * color_channels(image));
    });
}

Result<double> relative_rmse(const ImageF& reference, const ImageF& test, Mask keep) {
    return check(reference, test, keep).map([&] {
        double squares = 0;
        for (const Block& block : block_means(reference, test, keep)) {
            const glm::dvec3 difference = block.test - block.reference;
            squares += block.pixels * glm::dot(difference, difference);
        }
        const Totals t = totals(reference, keep);
        const auto values = double(t.pixels * color_channels(reference));
        return ratio(std::sqrt(squares / values), t.color.magnitude / values);
    });
}

Result<double> bias(const ImageF& reference, const ImageF& test, Mask keep) {
    return check(reference, test, keep).and_then([&]() -> Result<double> {
        const double reference_mean = *mean(reference, keep);
        const double test_mean = *mean(test, keep);
        if (reference_mean == 0 && test_mean == 0) return 0.0;
        return ratio(test_mean, reference_mean) - 1;
    });
}

Result<double> percentile95_relative(const ImageF& reference, const ImageF& test, Mask keep) {
    return check(reference, test, keep).map([&] {
        const std::vector<Block> blocks = block_means(reference, test, keep);
        double mean_length = 0;
        for (const Block& block : blocks) mean_length += glm::length(block.reference) / double(blocks.size());

        std::vector<double> differences;
        differences.reserve(blocks.size());
        for (const Block& block : blocks) {
            differences.push_back(ratio(glm::length(block.test - block.reference),
                                        std::max(glm::length(block.reference), 0.01 * mean_length)));
            if (std::isnan(differences.back()) || !std::isfinite(glm::length(block.test))) {
                return std::numeric_limits<double>::quiet_NaN();
            }
        }
        const auto rank = size_t(std::ceil(0.95 * double(differences.size()))) - 1;
        std::ranges::nth_element(differences, differences.begin() + ptrdiff_t(rank));
        return differences[rank];
    });
}

Result<double> automatic_exposure(const ImageF& radiance, Mask keep) {
    return check_image(radiance).and_then([&] { return check_mask(radiance, keep); }).map([&] {
        double logarithms = 0;
        uint64_t count = 0;
        for_each_kept(radiance, keep, [&](uint32_t x, uint32_t y) {
            const double l = luminance(radiance.at(x, y), radiance.channels);
            if (!std::isfinite(l) || l <= 0) return;
            logarithms += std::log2(l);
            ++count;
        });
        return count == 0 ? 0.0 : std::log2(0.18) - logarithms / double(count);
    });
}

ImageF tone_mapped(const ImageF& radiance, double stops) {
    const double exposure = std::exp2(stops);
    return mapped_rgb(radiance, [&](const float* pixel, uint32_t channel) {
        const double l = std::max(luminance(pixel, radiance.channels) * exposure, 0.0);
        const double value = pixel[channel] * exposure;
        // An infinite value over an infinite luminance is no number; on a display it is white.
        return std::isinf(value) ? double(value > 0) : std::clamp(value / (1 + l), 0.0, 1.0);
    });
}

ImageF decoded_srgb(const ImageF& encoded) {
    return mapped_rgb(encoded, [](const float* pixel, uint32_t channel) {
        const double v = pixel[channel];
        return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    });
}

Result<Parity> parity(const ImageF& a, const ImageF& b, const ParityRule& rule, size_t max_misses) {
    return check_pair(a, b).map([&] {
        const auto milder = [](const ParityMiss& l, const ParityMiss& r) {
            return std::tie(l.times_bound, r.y, r.x, r.channel) >
                   std::tie(r.times_bound, l.y, l.x, l.channel);
        };
        Parity result{
            .rule = rule, .pixels = uint64_t(a.width) * a.height, .mean_magnitude = mean_magnitude(a, b)};
        for_each_kept(a, {}, [&](uint32_t x, uint32_t y) {
            bool all_identical = true;
            bool any_beyond = false;
            for (uint32_t c = 0; c < a.channels; ++c) {
                ParityMiss miss{x, y, c, a.at(x, y)[c], b.at(x, y)[c]};
                if (identical(miss.a, miss.b)) continue;
                all_identical = false;
                const bool finite = std::isfinite(miss.a) && std::isfinite(miss.b);
                if (finite) {
                    const double difference = std::abs(double(miss.a) - double(miss.b));
                    const double bound = std::max(
                        rule.absolute, rule.relative * scale_of(miss.a, miss.b, result.mean_magnitude));
                    miss.times_bound = ratio(difference, bound);
                    result.worst_difference = std::max(result.worst_difference, difference);
                } else {
                    miss.times_bound = infinity;
                }
                result.worst_times_bound = std::max(result.worst_times_bound, miss.times_bound);
                if (miss.times_bound <= 1) continue;
                any_beyond = true;
                // A heap whose top is the mildest of those kept, to be dropped first.
                result.misses.push_back(miss);
                std::ranges::push_heap(result.misses, milder);
                if (result.misses.size() > max_misses) {
                    std::ranges::pop_heap(result.misses, milder);
                    result.misses.pop_back();
                }
            }
            result.pixels_identical += all_identical;
            result.pixels_beyond += any_beyond;
        });
        std::ranges::sort_heap(result.misses, milder);
        // The allowance is rounded to a pixel before it is cut, so that 1e-4 of 10 000 is one.
        const double allowed = (1 - rule.fraction) * double(result.pixels);
        result.passed = double(result.pixels_beyond) <= std::floor(allowed + 1e-6);
        return result;
    });
}

Result<ImageF> difference_picture(const ImageF& a, const ImageF& b, double lowest, double highest) {
    if (!(lowest > 0 && lowest < highest)) {
        return fail(ErrorKind::invalid_argument, "scale", fmt::format("{} to {}", lowest, highest),
                    "0 < lowest < highest");
    }
    return check_pair(a, b).map([&] {
        const double mean = mean_magnitude(a, b);
        ImageF out{a.width, a.height, 3, std::vector<float>(size_t(a.width) * a.height * 3)};
        for_each_kept(a, {}, [&](uint32_t x, uint32_t y) {
            double worst = 0;
            for (uint32_t c = 0; c < a.channels; ++c) {
                const float va = a.at(x, y)[c];
                const float vb = b.at(x, y)[c];
                if (identical(va, vb)) continue;
                const bool finite = std::isfinite(va) && std::isfinite(vb);
                worst = std::max(
                    worst, finite ? std::abs(double(va) - double(vb)) / scale_of(va, vb, mean) : infinity);
            }
            if (worst == 0) return;
            const glm::dvec3 color = std::isinf(worst)
                                         ? glm::dvec3(0, 1, 0)
                                         : heat(std::log(worst / lowest) / std::log(highest / lowest));
            for (int c = 0; c < 3; ++c) out.at(x, y)[c] = float(color[c]);
        });
        return out;
    });
}

Result<Comparison> compare(const ImageF& reference, const ImageF& test, const CompareOptions& options) {
    if (auto valid = check(reference, test, options.keep); !valid) return tl::unexpected(valid.error());
    const Mask keep = options.keep;
    Comparison result{.width = reference.width,
                      .height = reference.height,
                      .channels = reference.channels,
                      .pixels_kept = totals(reference, keep).pixels,
                      .not_finite_reference = count_not_finite(reference),
                      .not_finite_test = count_not_finite(test),
                      .mean_reference = *mean(reference, keep),
                      .mean_test = *mean(test, keep),
                      .relative_rmse = *relative_rmse(reference, test, keep),
                      .bias = *bias(reference, test, keep),
                      .percentile95_relative = *percentile95_relative(reference, test, keep),
                      .parity = *parity(reference, test, options.parity_rule, options.max_misses)};
    if (!options.encoded_srgb) {
        result.exposure = options.exposure ? *options.exposure : *automatic_exposure(reference, keep);
    }
    const auto display = [&](const ImageF& image) {
        return result.exposure ? tone_mapped(image, *result.exposure) : decoded_srgb(image);
    };
    return flip(display(reference), display(test), options.pixels_per_degree).map([&](const ImageF& errors) {
        result.flip_mean = *mean(errors, keep);
        return std::move(result);
    });
}

}  // namespace lumo::reference
