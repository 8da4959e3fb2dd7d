#include "samples/lumo/report/error_map.hpp"

#include <algorithm>
#include <cmath>

namespace lumo::program {
namespace {

constexpr uint32_t block_side = 4;  // pixels, as in reference::relative_rmse
constexpr std::array<uint8_t, 3> left_out_color{128, 128, 128};

/// Fills the block of a pixel.
void fill(scene::Image8& image, uint32_t left, uint32_t top, reference::Mask keep,
          const std::array<uint8_t, 3>& color) {
    for (uint32_t y = top; y < std::min(top + block_side, image.height); ++y)
        for (uint32_t x = left; x < std::min(left + block_side, image.width); ++x)
            std::ranges::copy(keep[size_t(y) * image.width + x] ? color : left_out_color, image.at(x, y));
}

}  // namespace

std::array<uint8_t, 3> signed_color(double value) {
    constexpr std::array<double, 3> below{25, 70, 160}, equal{255, 255, 255}, above{175, 25, 30};
    const auto& end = value < 0 ? below : above;
    const double part = std::isfinite(value) ? std::min(std::abs(value), 1.0) : 1;
    std::array<uint8_t, 3> color{};
    for (size_t i = 0; i < 3; ++i) color[i] = uint8_t(std::lround(equal[i] + part * (end[i] - equal[i])));
    return color;
}

Result<scene::Image8> error_map(const scene::ImageF& reference, const scene::ImageF& test,
                                reference::Mask keep) {
    const auto mean = reference::mean(reference, keep);
    if (!mean) return tl::unexpected(mean.error());
    if (test.width != reference.width || test.height != reference.height ||
        test.channels != reference.channels)
        return fail(ErrorKind::invalid_argument, "error map", "the pictures differ in size");
    const uint32_t colors = std::min(reference.channels, 3u);
    scene::Image8 map{.width = reference.width, .height = reference.height, .channels = 3};
    map.values.resize(size_t(map.width) * map.height * 3);
    for (uint32_t top = 0; top < map.height; top += block_side) {
        for (uint32_t left = 0; left < map.width; left += block_side) {
            double difference = 0;
            uint32_t count = 0;
            for (uint32_t y = top; y < std::min(top + block_side, map.height); ++y) {
                for (uint32_t x = left; x < std::min(left + block_side, map.width); ++x) {
                    if (!keep[size_t(y) * map.width + x]) continue;
                    for (uint32_t c = 0; c < colors; ++c, ++count)
                        difference += double(test.at(x, y)[c]) - double(reference.at(x, y)[c]);
                }
            }
            const double relative = count > 0 && *mean > 0 ? difference / count / *mean : difference;
            fill(map, left, top, keep, signed_color(relative / error_map_range));
        }
    }
    return map;
}

scene::Image8 displayed(const scene::ImageF& radiance, double stops) {
    const scene::ImageF linear = reference::tone_mapped(radiance, stops);
    scene::Image8 image{.width = linear.width, .height = linear.height, .channels = linear.channels};
    image.values.reserve(linear.values.size());
    for (const float value : linear.values) {
        const float encoded = !(value > 0)          ? 0  // also of what is no number
                              : value <= 0.0031308f ? 12.92f * value
                                                    : 1.055f * std::pow(value, 1 / 2.4f) - 0.055f;
        image.values.push_back(uint8_t(std::lround(255 * std::min(encoded, 1.0f))));
    }
    return image;
}

}  // namespace lumo::program
