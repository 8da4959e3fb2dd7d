#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "scene/mips.hpp"

namespace lumo::scene {
namespace {

double decode(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double encode(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

Image8 noise(uint32_t width, uint32_t height) {
    Image8 image{width, height, 4, std::vector<uint8_t>(size_t(width) * height * 4)};
    std::mt19937 random(7);
    for (uint8_t& v : image.values) v = uint8_t(random() & 255);
    return image;
}

/// The mean of the area of `image` that texel (x, y) of a level of size width x height covers, level by
/// level.
std::vector<double> half(const std::vector<double>& image, uint32_t w, uint32_t h, uint32_t w2, uint32_t h2) {
    std::vector<double> out(size_t(w2) * h2);
    for (uint32_t y = 0; y < h2; ++y)
        for (uint32_t x = 0; x < w2; ++x) {
            double sum = 0;
            for (uint32_t j = 0; j < h; ++j)
                for (uint32_t i = 0; i < w; ++i) {
                    const auto overlap = [](double a0, double a1, double b0, double b1) {
                        return std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
                    };
                    const double sx = double(w) / w2, sy = double(h) / h2;
                    sum += image[size_t(j) * w + i] * overlap(x * sx, (x + 1) * sx, i, i + 1) / sx *
                           overlap(y * sy, (y + 1) * sy, j, j + 1) / sy;
                }
            out[size_t(y) * w2 + x] = sum;
        }
    return out;
}

void expect_mean_of_area(uint32_t width, uint32_t height, Encoding encoding) {
    const Image8 image = noise(width, height);
    const std::vector<Image8> mips = lower_mips(image, encoding);
    for (size_t channel = 0; channel < 4; ++channel) {
        const bool curved = encoding == Encoding::srgb && channel < 3;
        std::vector<double> level;
        for (size_t i = channel; i < image.values.size(); i += 4)
            level.push_back(curved ? decode(image.values[i] / 255.0) : image.values[i] / 255.0);
        uint32_t w = width, h = height;
        for (const Image8& mip : mips) {
            level = half(level, w, h, mip.width, mip.height);
            w = mip.width;
            h = mip.height;
            for (size_t i = 0; i < level.size(); ++i) {
                const double wanted = 255 * (curved ? encode(level[i]) : level[i]);
                ASSERT_NEAR(mip.values[4 * i + channel], wanted, 0.52) << w << "x" << h << " texel " << i;
            }
        }
    }
    EXPECT_EQ(mips.back().width, 1u);
    EXPECT_EQ(mips.back().height, 1u);
}

TEST(Mips, AreMeansInLinearLight) { expect_mean_of_area(32, 16, Encoding::srgb); }
TEST(Mips, AreMeansOfData) { expect_mean_of_area(16, 16, Encoding::linear); }
TEST(Mips, CoverOddSidesEvenly) {
    expect_mean_of_area(13, 7, Encoding::srgb);
    expect_mean_of_area(5, 1, Encoding::linear);
    expect_mean_of_area(1, 3, Encoding::linear);
}
TEST(Mips, HalveAndRoundDown) {
    const std::vector<Image8> mips = lower_mips(noise(13, 6), Encoding::linear);
    ASSERT_EQ(mips.size(), 3u);
    EXPECT_EQ(mips[0].width, 6u);
    EXPECT_EQ(mips[0].height, 3u);
    EXPECT_EQ(mips[1].width, 3u);
    EXPECT_EQ(mips[1].height, 1u);
    EXPECT_EQ(mips[2].width, 1u);
    EXPECT_TRUE(lower_mips(noise(1, 1), Encoding::srgb).empty());
}

/// Thin stripes average to less than the cutoff: plain mips lose them, covered ones must not.
TEST(Mips, KeepTheCoverageOfAlpha) {
    Image8 image{64, 64, 4, std::vector<uint8_t>(size_t(64) * 64 * 4)};
    std::mt19937 random(3);
    for (size_t i = 3; i < image.values.size(); i += 4) image.values[i] = random() % 10 < 3 ? 255 : 0;
    const auto covered = [](const Image8& level) {
        double sum = 0;
        for (size_t i = 3; i < level.values.size(); i += 4) sum += level.values[i] >= 128;
        return sum / (double(level.width) * level.height);
    };
    const double wanted = covered(image);
    const std::vector<Image8> plain = lower_mips(image, Encoding::srgb);
    const std::vector<Image8> kept = lower_mips(image, Encoding::srgb, 0.5f);
    EXPECT_LT(covered(plain[2]), 0.5 * wanted);
    // The alphas of a level are binomial: no threshold comes nearer than half of the most frequent value's
    // share.
    EXPECT_NEAR(covered(kept[0]), wanted, 0.42 / 2);
    EXPECT_NEAR(covered(kept[1]), wanted, 0.22 / 2);
    EXPECT_NEAR(covered(kept[2]), wanted, 0.12 / 2);
}

TEST(Mips, LeaveOpaqueAlphaAlone) {
    Image8 image = noise(8, 8);
    for (size_t i = 3; i < image.values.size(); i += 4) image.values[i] = 255;
    for (const Image8& mip : lower_mips(image, Encoding::srgb, 0.5f))
        for (size_t i = 3; i < mip.values.size(); i += 4) EXPECT_EQ(mip.values[i], 255);
}

}  // namespace
}  // namespace lumo::scene
