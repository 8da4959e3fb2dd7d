#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "reference/metrics.hpp"
#include "reference/metrics_report.hpp"

namespace lumo::reference {
namespace {

using scene::ImageF;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

ImageF make(uint32_t width, uint32_t height, uint32_t channels,
            const std::function<float(uint32_t x, uint32_t y, uint32_t channel)>& value) {
    ImageF image{width, height, channels, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            for (uint32_t c = 0; c < channels; ++c) image.values.push_back(value(x, y, c));
        }
    }
    return image;
}

ImageF constant(uint32_t width, uint32_t height, float value, uint32_t channels = 3) {
    return make(width, height, channels, [=](auto...) { return value; });
}

ImageF with(ImageF image, uint32_t x, uint32_t y, uint32_t channel, float value) {
    image.at(x, y)[channel] = value;
    return image;
}

// -- relative RMSE ------------------------------------------------------------------------------------

TEST(RelativeRmse, OfAConstantOffsetIsTheOffsetOverTheMean) {
    EXPECT_NEAR(*relative_rmse(constant(16, 8, 2), constant(16, 8, 2.5f)), 0.25, 1e-12);
    EXPECT_NEAR(*relative_rmse(constant(16, 8, 2.5f), constant(16, 8, 2)), 0.2, 1e-12);
}

TEST(RelativeRmse, OfNoiseFallsByFourInBlocksOfSixteenPixels) {
    std::mt19937 random(7);
    std::normal_distribution<float> noise(0, 0.8f);
    const ImageF test = make(256, 256, 3, [&](auto...) { return 10 + noise(random); });
    // 12288 block means: their RMS is 0.8 / 4 to within one part in sqrt(2 * 12288).
    EXPECT_NEAR(*relative_rmse(constant(256, 256, 10), test), 0.8 / 4 / 10, 0.02 * 4 / 156);
}

TEST(RelativeRmse, DoesNotSeeWhatCancelsInABlock) {
    const ImageF checker =
        make(8, 8, 3, [](uint32_t x, uint32_t y, uint32_t) { return (x + y) % 2 ? 2.f : 0.f; });
    EXPECT_EQ(*relative_rmse(constant(8, 8, 1), checker), 0);
}

TEST(RelativeRmse, WeighsPartialBlocksByTheirPixels) {
    // 5x1: a block of four pixels that is right, one of one pixel that is off by 1. sqrt(1 * 1² / 5) / 2.
    const ImageF test = with(constant(5, 1, 2, 1), 4, 0, 0, 3);
    EXPECT_NEAR(*relative_rmse(constant(5, 1, 2, 1), test), std::sqrt(0.2) / 2, 1e-12);
}

TEST(RelativeRmse, PoolsTheColourChannelsAndLeavesOutAlpha) {
    // Differences 0, 1, 2 in the channels: sqrt((0 + 1 + 4) / 3) over a mean of 4.
    const ImageF test =
        make(4, 4, 4, [](uint32_t, uint32_t, uint32_t c) { return c == 3 ? 9.f : 4.f + float(c); });
    EXPECT_NEAR(*relative_rmse(constant(4, 4, 4, 4), test), std::sqrt(5.0 / 3) / 4, 1e-12);
}

TEST(RelativeRmse, LeavesOutMaskedPixelsFromBlocksAndMean) {
    // One block. Kept: the top row, reference 2, test 3; the emitter below would rule otherwise.
    const ImageF reference =
        make(4, 4, 3, [](uint32_t, uint32_t y, uint32_t) { return y == 0 ? 2.f : 1000.f; });
    const ImageF test = make(4, 4, 3, [](uint32_t, uint32_t y, uint32_t) { return y == 0 ? 3.f : 0.f; });
    const ImageF emission =
        make(4, 4, 3, [](uint32_t, uint32_t y, uint32_t c) { return y > 0 && c == 2 ? 7.f : 0.f; });
    const std::vector<uint8_t> keep = *mask_of_reflectors(emission);
    EXPECT_THAT(std::vector(keep.begin(), keep.begin() + 5), ElementsAre(1, 1, 1, 1, 0));
    EXPECT_NEAR(*relative_rmse(reference, test, keep), 0.5, 1e-12);
    EXPECT_NEAR(*bias(reference, test, keep), 0.5, 1e-12);
    EXPECT_NEAR(*percentile95_relative(reference, test, keep), 0.5, 1e-12);
    EXPECT_GT(*relative_rmse(reference, test), 0.9);
}

TEST(RelativeRmse, OfABlackReferenceIsZeroOrInfinite) {
    EXPECT_EQ(*relative_rmse(constant(4, 4, 0), constant(4, 4, 0)), 0);
    EXPECT_EQ(*relative_rmse(constant(4, 4, 0), constant(4, 4, 1)), inf);
}

TEST(RelativeRmse, IsNoNumberWhereAValueIsNone) {
    const ImageF broken = with(constant(8, 8, 1), 3, 3, 1, nan);
    EXPECT_TRUE(std::isnan(*relative_rmse(constant(8, 8, 1), broken)));
    EXPECT_TRUE(std::isnan(*relative_rmse(broken, constant(8, 8, 1))));
    EXPECT_TRUE(std::isnan(*relative_rmse(constant(8, 8, 0), broken)));
    EXPECT_FALSE(std::isfinite(*relative_rmse(constant(8, 8, 1), with(constant(8, 8, 1), 0, 0, 0, inf))));
}

// -- bias and percentile
// ---------------------------------------------------------------------------------------

TEST(Bias, IsSignedAndZeroForNoiseThatCancels) {
    EXPECT_NEAR(*bias(constant(4, 4, 2), constant(4, 4, 2.5f)), 0.25, 1e-12);
    EXPECT_NEAR(*bias(constant(4, 4, 2.5f), constant(4, 4, 2)), -0.2, 1e-12);
    const ImageF halves = make(8, 8, 3, [](uint32_t x, uint32_t, uint32_t) { return x < 4 ? 1.f : 3.f; });
    EXPECT_EQ(*bias(constant(8, 8, 2), halves), 0);
    EXPECT_EQ(*bias(constant(4, 4, 0), constant(4, 4, 0)), 0);
    EXPECT_EQ(*bias(constant(4, 4, 0), constant(4, 4, 1)), inf);
}

TEST(Percentile95, IsTheNearestRankOverBlocks) {
    // 20 blocks in a row, of which block i is off by i parts in a hundred: the 19th of 20 is off by 18.
    const ImageF test = make(80, 4, 3, [](uint32_t x, uint32_t, uint32_t) {
        const uint32_t block = x / 4;
        return 1 + float(block) / 100;
    });
    EXPECT_NEAR(*percentile95_relative(constant(80, 4, 1), test), 0.18, 1e-6);
}

TEST(Percentile95, HoldsBlackBlocksAgainstAHundredthOfTheMean) {
    // Every block of two is black in the reference; its mean length over all is sqrt(3), a hundredth of it is
    // the floor.
    const ImageF reference = make(8, 4, 3, [](uint32_t x, uint32_t, uint32_t) { return x < 4 ? 0.f : 2.f; });
    const ImageF test = make(8, 4, 3, [](uint32_t x, uint32_t, uint32_t) { return x < 4 ? 0.001f : 2.f; });
    EXPECT_NEAR(*percentile95_relative(reference, test), 0.1, 1e-6);
    EXPECT_EQ(*percentile95_relative(constant(4, 4, 0), constant(4, 4, 0)), 0);
    EXPECT_EQ(*percentile95_relative(constant(4, 4, 0), constant(4, 4, 1)), inf);
    EXPECT_TRUE(
        std::isnan(*percentile95_relative(constant(80, 80, 1), with(constant(80, 80, 1), 0, 0, 0, inf))));
    EXPECT_TRUE(
        std::isnan(*percentile95_relative(constant(80, 80, 1), with(constant(80, 80, 1), 0, 0, 0, nan))));
}

// -- what cannot be compared ----------------------------------------------------------------------------

TEST(Metrics, RefuseWhatDoesNotMatch) {
    const ImageF a = constant(4, 4, 1);
    const auto refuses = [](const auto& result) {
        EXPECT_FALSE(result) << "accepted";
        if (!result) {
            EXPECT_EQ(result.error().kind, ErrorKind::invalid_argument);
            EXPECT_FALSE(result.error().message.empty());
        }
    };
    for (const ImageF& b : {constant(4, 5, 1), constant(5, 4, 1), constant(4, 4, 1, 4), ImageF{},
                            ImageF{4, 4, 3, std::vector<float>(47)}}) {
        refuses(relative_rmse(a, b));
        refuses(bias(a, b));
        refuses(percentile95_relative(a, b));
        refuses(parity(a, b, mesa_parity));
        refuses(difference_picture(a, b));
        refuses(compare(a, b));
        refuses(flip(a, b));
    }
    refuses(relative_rmse(constant(2, 2, 1, 5), constant(2, 2, 1, 5)));
    refuses(flip(constant(2, 2, 1, 1), constant(2, 2, 1, 1)));
    refuses(mask_of_reflectors(ImageF{4, 4, 3, std::vector<float>(47)}));
    refuses(flip(a, a, 0));
    refuses(flip(a, a, nan));
    refuses(difference_picture(a, a, 0, 1));
    const std::vector<uint8_t> nothing(16, 0);
    const std::vector<uint8_t> short_mask(15, 1);
    for (const Mask mask : {Mask(nothing), Mask(short_mask)}) {
        refuses(relative_rmse(a, a, mask));
        refuses(bias(a, a, mask));
        refuses(percentile95_relative(a, a, mask));
        refuses(mean(a, mask));
        refuses(automatic_exposure(a, mask));
        refuses(compare(a, a, {.keep = mask}));
    }
}

// -- parity
// ------------------------------------------------------------------------------------------------------

TEST(Parity, BoundIsRelativeToTheGreatestOfBothAndTheMean) {
    const ParityRule rule{.relative = 0.01, .fraction = 1};
    // The mean of both pictures is 1 to within a part in a thousand; a pixel near black is held against it.
    const auto verdict = [&](float a, float b) {
        const ImageF base = constant(100, 100, 1, 1);
        return parity(with(base, 50, 20, 0, a), with(base, 50, 20, 0, b), rule)->passed;
    };
    EXPECT_TRUE(verdict(0, 0.0099f));
    EXPECT_FALSE(verdict(0, 0.0101f));
    EXPECT_FALSE(verdict(0.0101f, 0));
    EXPECT_TRUE(verdict(10, 10.1f));
    EXPECT_TRUE(verdict(10.1f, 10));
    EXPECT_FALSE(verdict(10, 10.102f));
    EXPECT_FALSE(verdict(10.102f, 10));
}

TEST(Parity, ListsTheWorstFirstAndCountsAll) {
    const ImageF a = constant(10, 10, 1);
    ImageF b = with(with(with(a, 3, 4, 0, 1.5f), 3, 4, 2, 1.25f), 9, 0, 1, 2);
    const Result<Parity> all = parity(a, b, mesa_parity);
    EXPECT_EQ(all->pixels, 100u);
    EXPECT_EQ(all->pixels_beyond, 2u);
    EXPECT_EQ(all->pixels_identical, 98u);
    EXPECT_FALSE(all->passed);
    EXPECT_EQ(all->worst_difference, 1);
    ASSERT_EQ(all->misses.size(), 3u);
    EXPECT_EQ(all->misses[0].x, 9u);
    EXPECT_EQ(all->misses[0].y, 0u);
    EXPECT_EQ(all->misses[0].channel, 1u);
    EXPECT_EQ(all->misses[0].a, 1);
    EXPECT_EQ(all->misses[0].b, 2);
    EXPECT_NEAR(all->misses[0].times_bound, 5000, 1e-6);  // 1 over 1e-4 of 2
    EXPECT_EQ(all->misses[1].channel, 0u);
    EXPECT_EQ(all->misses[2].channel, 2u);

    const Result<Parity> two = parity(a, b, mesa_parity, 2);
    ASSERT_EQ(two->misses.size(), 2u);
    EXPECT_EQ(two->misses[0].x, 9u);
    EXPECT_EQ(two->misses[1].channel, 0u);
    EXPECT_EQ(two->pixels_beyond, 2u);
    EXPECT_TRUE(parity(a, b, mesa_parity, 0)->misses.empty());
}

TEST(Parity, AllowsTheStatedFractionAndNotAPixelMore) {
    const ImageF a = constant(200, 100, 1, 1);  // a ten-thousandth of it is two pixels
    ImageF b = with(with(a, 0, 0, 0, 2), 1, 0, 0, 2);
    EXPECT_TRUE(parity(a, b, mesa_parity)->passed);
    EXPECT_FALSE(parity(a, with(b, 2, 0, 0, 2), mesa_parity)->passed);
    EXPECT_TRUE(parity(a, with(b, 2, 0, 0, 2), hardware_parity)->passed);
    EXPECT_FALSE(parity(constant(10, 10, 1), with(constant(10, 10, 1), 0, 0, 0, 2), mesa_parity)->passed);
}

TEST(Parity, NamedRulesTellTheirTolerancesApart) {
    const ImageF a = constant(10, 10, 1);
    EXPECT_TRUE(parity(a, constant(10, 10, 1.00009f), mesa_parity)->passed);
    EXPECT_FALSE(parity(a, constant(10, 10, 1.00011f), mesa_parity)->passed);
    EXPECT_TRUE(parity(a, constant(10, 10, 1.0009f), hardware_parity)->passed);
    EXPECT_FALSE(parity(a, constant(10, 10, 1.0011f), hardware_parity)->passed);
}

TEST(Parity, OfPngIsOneStepAtEveryLevel) {
    for (int level = 0; level < 254; ++level) {
        const ImageF a = constant(2, 2, float(level) / 255);
        EXPECT_TRUE(parity(a, constant(2, 2, float(level + 1) / 255), mesa_png_parity)->passed) << level;
        EXPECT_FALSE(parity(a, constant(2, 2, float(level + 2) / 255), hardware_png_parity)->passed) << level;
    }
}

TEST(Parity, HoldsWhatIsNotFiniteAgainstItsLike) {
    const ImageF base = constant(4, 4, 1);
    const auto beyond = [&](float a, float b) {
        return parity(with(base, 1, 2, 0, a), with(base, 1, 2, 0, b), hardware_parity)->pixels_beyond;
    };
    EXPECT_EQ(beyond(nan, nan), 0u);
    EXPECT_EQ(beyond(inf, inf), 0u);
    EXPECT_EQ(beyond(-inf, -inf), 0u);
    EXPECT_EQ(beyond(nan, 1), 1u);
    EXPECT_EQ(beyond(1, nan), 1u);
    EXPECT_EQ(beyond(inf, 1), 1u);
    EXPECT_EQ(beyond(inf, -inf), 1u);
    EXPECT_EQ(beyond(inf, nan), 1u);
    // Neither it nor a value gone wild may widen the bound of the others through the mean.
    EXPECT_EQ(parity(base, with(with(base, 0, 0, 0, 1e9f), 3, 3, 0, 1.5f), hardware_parity)->pixels_beyond,
              2u);
    const ImageF a = with(base, 0, 0, 0, inf);
    EXPECT_EQ(parity(a, with(a, 3, 3, 0, 1.5f), hardware_parity)->pixels_beyond, 1u);
    EXPECT_EQ(parity(a, with(base, 0, 0, 0, nan), hardware_parity)->misses.at(0).times_bound, inf);
}

TEST(Parity, ComparesAlpha) {
    const ImageF a = constant(4, 4, 1, 4);
    EXPECT_FALSE(parity(a, with(a, 0, 0, 3, 0), mesa_parity)->passed);
}

TEST(Parity, OfBlackPicturesPassesOnlyBlack) {
    const ImageF black = constant(4, 4, 0);
    EXPECT_TRUE(parity(black, black, mesa_parity)->passed);
    EXPECT_FALSE(parity(black, with(black, 0, 0, 0, 1e-30f), mesa_parity)->passed);
}

// -- pictures
// --------------------------------------------------------------------------------------------------

double brightness(const ImageF& image, uint32_t x) {
    return image.at(x, 0)[0] + image.at(x, 0)[1] + image.at(x, 0)[2];
}

TEST(DifferencePicture, RisesWithTheDifferenceAndMarksWhatIsNotFinite) {
    const ImageF a = constant(8, 1, 1);
    ImageF b = a;
    const std::array differences{0.f, 1e-6f, 1e-5f, 1e-4f, 1e-2f, 0.5f};
    for (uint32_t x = 0; x < differences.size(); ++x) b.at(x, 0)[x % 3] = 1 - differences[x];
    b.at(6, 0)[1] = nan;
    b.at(7, 0)[2] = 1e30f;
    const ImageF picture = *difference_picture(a, b);
    EXPECT_EQ(picture.channels, 3u);
    EXPECT_EQ(brightness(picture, 0), 0);
    for (uint32_t x = 1; x < 6; ++x) EXPECT_GT(brightness(picture, x), brightness(picture, x - 1)) << x;
    EXPECT_THAT(std::vector(picture.at(6, 0), picture.at(6, 0) + 3), ElementsAre(0, 1, 0));
    EXPECT_THAT(std::vector(picture.at(7, 0), picture.at(7, 0) + 3), ElementsAre(1, 1, 0.85f));
    EXPECT_EQ(difference_picture(b, a)->values, picture.values);
}

TEST(ToneMapped, CompressesLuminanceAndKeepsHue) {
    const ImageF grey = tone_mapped(constant(1, 1, 0.5f), 1);
    for (float v : grey.values) EXPECT_FLOAT_EQ(v, 0.5f);  // 2 * 0.5 / (1 + 1)
    const ImageF radiance{1, 1, 3, {0.4f, 0.2f, 0.1f}};
    const ImageF color = tone_mapped(radiance, 0);
    const float luminance = 0.2126f * 0.4f + 0.7152f * 0.2f + 0.0722f * 0.1f;
    EXPECT_NEAR(color.values[0], 0.4f / (1 + luminance), 1e-6);
    EXPECT_NEAR(color.values[0] / color.values[2], 4, 1e-5);
    EXPECT_THAT(tone_mapped(ImageF{2, 1, 1, {inf, -1}}, 0).values, ElementsAre(1, 1, 1, 0, 0, 0));
}

TEST(AutomaticExposure, BringsTheLogAverageToMiddleGrey) {
    // The log average of 0.09 and 1.44 is 0.36: one stop too bright. Black does not count.
    const ImageF image = make(3, 1, 3, [](uint32_t x, uint32_t, uint32_t) {
        return std::array{0.09f, 1.44f, 0.f}[x];
    });
    EXPECT_NEAR(*automatic_exposure(image), -1, 1e-6);
    const std::vector<uint8_t> keep{1, 0, 0};
    EXPECT_NEAR(*automatic_exposure(image, keep), 1, 1e-6);
    EXPECT_EQ(*automatic_exposure(constant(2, 2, 0)), 0);
}

TEST(DecodedSrgb, MeetsTheStandardsPoints) {
    const ImageF decoded = decoded_srgb(ImageF{4, 1, 1, {0, 0.04045f, 188.f / 255, 1}});
    EXPECT_NEAR(decoded.values[0], 0, 1e-7);
    EXPECT_NEAR(decoded.values[3], 0.0031308, 1e-6);
    EXPECT_NEAR(decoded.values[6], 0.5029, 1e-4);
    EXPECT_NEAR(decoded.values[9], 1, 1e-6);
}

// -- ꟻLIP
// -------------------------------------------------------------------------------------------------------

ImageF pattern(uint32_t shift, float scale) {
    return make(64, 48, 3, [=](uint32_t x, uint32_t y, uint32_t c) {
        return scale * float(((x + shift) / 8 * 7 + y / 8 * 13 + (x * y % 5) + c * 29) % 32) / 31;
    });
}

ImageF plain(float r, float g, float b) {
    return make(32, 32, 3, [=](uint32_t, uint32_t, uint32_t c) { return std::array{r, g, b}[c]; });
}

// The expected means are those of the authors' own program (version 1.7) for the same pixels.
TEST(Flip, AgreesWithTheAuthorsProgram) {
    const auto flip_mean = [](const ImageF& reference, const ImageF& test, double pixels_per_degree) {
        return *mean(*flip(reference, test, pixels_per_degree));
    };
    constexpr double ppd = default_pixels_per_degree;
    EXPECT_NEAR(flip_mean(pattern(0, 1), pattern(3, 1), ppd), 0.400808, 3e-5);
    EXPECT_NEAR(flip_mean(pattern(0, 0.2f), pattern(1, 0.25f), ppd), 0.226993, 3e-5);
    EXPECT_NEAR(flip_mean(pattern(0, 1), pattern(3, 1), 30), 0.369930, 3e-5);
    EXPECT_NEAR(flip_mean(plain(0, 0, 0), plain(1, 1, 1), ppd), 0.967394, 3e-5);
    EXPECT_NEAR(flip_mean(plain(0.2f, 0.2f, 0.2f), plain(0.22f, 0.22f, 0.22f), ppd), 0.099615, 3e-5);
    EXPECT_NEAR(flip_mean(plain(0.8f, 0.1f, 0.1f), plain(0.1f, 0.8f, 0.1f), ppd), 0.972458, 3e-5);
}

TEST(Flip, IsZeroForEqualOneForGreenAgainstBlueAndSymmetric) {
    EXPECT_EQ(*mean(*flip(pattern(0, 1), pattern(0, 1))), 0);
    EXPECT_NEAR(*mean(*flip(plain(0, 1, 0), plain(0, 0, 1))), 1, 1e-6);
    EXPECT_EQ(flip(pattern(0, 1), pattern(3, 1))->values, flip(pattern(3, 1), pattern(0, 1))->values);
}

TEST(Flip, IsNoNumberNearAValueThatIsNone) {
    const ImageF errors = *flip(plain(0.5f, 0.5f, 0.5f), with(plain(0.5f, 0.5f, 0.5f), 0, 0, 0, nan));
    EXPECT_TRUE(std::isnan(*errors.at(0, 0)));
    EXPECT_EQ(*errors.at(31, 31), 0);
}

// -- all of it
// ---------------------------------------------------------------------------------------------------

TEST(Compare, GathersWhatTheFunctionsSay) {
    const ImageF reference = pattern(0, 3);
    const ImageF test = pattern(1, 3.3f);
    std::vector<uint8_t> keep(64 * 48, 1);
    keep[100] = 0;
    const Comparison c =
        *compare(reference, test, {.keep = keep, .parity_rule = hardware_parity, .max_misses = 5});
    EXPECT_EQ(c.width, 64u);
    EXPECT_EQ(c.height, 48u);
    EXPECT_EQ(c.channels, 3u);
    EXPECT_EQ(c.pixels_kept, 64u * 48 - 1);
    EXPECT_EQ(c.mean_reference, *mean(reference, keep));
    EXPECT_EQ(c.mean_test, *mean(test, keep));
    EXPECT_EQ(c.relative_rmse, *relative_rmse(reference, test, keep));
    EXPECT_EQ(c.bias, *bias(reference, test, keep));
    EXPECT_EQ(c.percentile95_relative, *percentile95_relative(reference, test, keep));
    const double stops = *automatic_exposure(reference, keep);
    EXPECT_EQ(c.exposure, stops);
    EXPECT_EQ(c.flip_mean, *mean(*flip(tone_mapped(reference, stops), tone_mapped(test, stops)), keep));
    EXPECT_EQ(c.parity.pixels, 64u * 48);
    EXPECT_EQ(c.parity.rule.relative, 1e-3);
    EXPECT_EQ(c.parity.misses.size(), 5u);

    EXPECT_EQ(compare(reference, test, {.exposure = 2})->exposure, 2);
    const Comparison encoded = *compare(pattern(0, 1), pattern(3, 1), {.encoded_srgb = true});
    EXPECT_EQ(encoded.exposure, std::nullopt);
    EXPECT_EQ(encoded.flip_mean, *mean(*flip(decoded_srgb(pattern(0, 1)), decoded_srgb(pattern(3, 1)))));
}

TEST(Compare, CountsWhatIsNotFinite) {
    const ImageF base = constant(8, 8, 1);
    const Comparison c = *compare(with(base, 0, 0, 0, nan), with(with(base, 0, 0, 0, inf), 1, 0, 0, -inf));
    EXPECT_EQ(c.not_finite_reference, 1u);
    EXPECT_EQ(c.not_finite_test, 2u);
    EXPECT_FALSE(c.parity.passed);
    EXPECT_TRUE(std::isnan(c.relative_rmse));
}

TEST(Report, SaysFiguresVerdictAndWorstPixels) {
    const ImageF reference = constant(16, 16, 2);
    const Comparison c = *compare(reference, with(with(reference, 5, 6, 2, 2.5f), 7, 8, 0, nan));
    const std::string text = to_text(c, 1);
    EXPECT_THAT(text, HasSubstr("16x16"));
    EXPECT_THAT(text, HasSubstr("FAILED: 2 of 256 pixels beyond, 254 identical"));
    EXPECT_THAT(text, HasSubstr("0 reference, 1 test"));
    EXPECT_THAT(text, ::testing::ContainsRegex("7 +8 +0 +2 +nan +inf"));
    EXPECT_THAT(text, ::testing::Not(::testing::ContainsRegex("5 +6 +2 +2 +2.5")));

    const auto json = nlohmann::json::parse(to_json(c).dump());
    EXPECT_EQ(json["width"], 16);
    EXPECT_TRUE(json["relative_rmse"].is_null());
    EXPECT_EQ(json["not_finite_test"], 1);
    EXPECT_EQ(json["parity"]["passed"], false);
    EXPECT_EQ(json["parity"]["pixels_beyond"], 2);
    EXPECT_EQ(json["parity"]["rule"]["relative"], 1e-4);
    EXPECT_TRUE(json["parity"]["misses"][0]["b"].is_null());
    EXPECT_EQ(json["parity"]["misses"][1]["x"], 5);
    EXPECT_EQ(json["parity"]["misses"][1]["b"], 2.5);

    const Comparison good = *compare(reference, constant(16, 16, 2.00001f));
    EXPECT_THAT(to_text(good), HasSubstr("passed: 0 of 256 pixels beyond"));
    EXPECT_NEAR(double(to_json(good)["relative_rmse"]), 5e-6, 1e-7);
}

}  // namespace
}  // namespace lumo::reference
