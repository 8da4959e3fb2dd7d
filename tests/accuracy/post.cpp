// Tone curves and encoding against the formulas of their papers in double precision.
#include "techniques/post/post.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::post {
namespace {

using namespace testing_support;
using testing_support::must;
using Color = std::array<double, 3>;

struct PostTest : DeviceTest {
    /// The picture's values, 0 to 255, of a row of colours.
    std::vector<std::array<uint8_t, 4>> display(const std::vector<glm::vec4>& colors,
                                                const Settings& settings) {
        const rhi::Extent size{uint32_t(colors.size()), 1};
        const rhi::Texture radiance =
            texture({.name = "radiance", .format = rhi::Format::rgba32_float, .extent = size});
        must(device().upload(radiance, rhi::whole_mip(radiance.desc()), bytes_of(colors)));
        Post post = must(Post::create(device(), settings, size));
        rhi::Commands commands = device().begin();
        post.record(commands, radiance.view<rhi::Dimension::d2>());
        must(device().wait(device().submit(std::move(commands))));
        return texels<std::array<uint8_t, 4>>(post.display());
    }

    void expect_curve(Tonemap tonemap, const std::function<Color(Color)>& curve) {
        std::vector<glm::vec4> colors;
        for (int i = 0; i < 400; ++i) {
            const float v = std::exp2(-14 + 0.05f * float(i));
            colors.emplace_back(v, v, v, 1);
            colors.emplace_back(v, 0.3f * v, 0.05f * v, 1);
            colors.emplace_back(0, 0.5f * v, v, 1);
        }
        colors.emplace_back(0, 0, 0, 1);
        const auto pictures = display(colors, {.exposure = 1, .tonemap = tonemap});
        for (size_t i = 0; i < colors.size(); ++i) {
            Color color;
            for (int c = 0; c < 3; ++c) color[size_t(c)] = 2 * double(colors[i][c]);
            color = curve(color);
            for (size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(pictures[i][c], 255 * srgb_encode(std::clamp(color[c], 0.0, 1.0)), 0.51)
                    << "colour " << i << " channel " << c;
            ASSERT_EQ(pictures[i][3], 255);
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, PostTest, both_apis, api_name);

Color each(Color color, double (*curve)(double)) {
    for (double& v : color) v = curve(v);
    return color;
}

TEST_P(PostTest, NoneClipsAtOne) {
    expect_curve(Tonemap::none, [](Color color) { return color; });
}

TEST_P(PostTest, Reinhard) {
    expect_curve(Tonemap::reinhard, [](Color color) {
        const double luminance = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
        for (double& v : color) v /= 1 + luminance;
        return color;
    });
}

double hable(double x) {
    return (x * (0.15 * x + 0.10 * 0.50) + 0.20 * 0.02) / (x * (0.15 * x + 0.50) + 0.20 * 0.30) - 0.02 / 0.30;
}
TEST_P(PostTest, Hable) {
    expect_curve(Tonemap::hable, [](Color color) {
        return each(color, [](double v) { return hable(2 * v) / hable(11.2); });
    });
}

TEST_P(PostTest, Aces) {
    expect_curve(Tonemap::aces, [](Color color) {
        return each(color, [](double v) {
            const double x = 0.6 * v;
            return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        });
    });
}

/// The sigmoid in the form of its own definition: scale from the slope and the limits, instead of numbers.
double agx(double stops) {
    const double pivot = 10 / 16.5, slope = 2;
    const double x = std::clamp((stops + 12.47393) / 16.5, 0.0, 1.0);
    const double power = x < pivot ? 3 : 3.25;
    const double run = x < pivot ? pivot : 1 - pivot;
    const double scale =
        std::pow(std::pow(slope * run, -power) * (std::pow(slope * run / 0.5, power) - 1), -1 / power);
    const double signed_scale = x < pivot ? -scale : scale;
    const double t = slope * (x - pivot) / signed_scale;
    return 0.5 + signed_scale * t / std::pow(1 + std::pow(t, power), 1 / power);
}
TEST_P(PostTest, Agx) {
    const glm::dmat3 inset(0.842479062253094, 0.0423282422610123, 0.0423756549057051, 0.0784335999999992,
                           0.878468636469772, 0.0784336, 0.0792237451477643, 0.0791661274605434,
                           0.879142973793104);
    expect_curve(Tonemap::agx, [&](Color color) {
        glm::dvec3 v = inset * glm::dvec3(color[0], color[1], color[2]);
        for (int c = 0; c < 3; ++c) v[c] = agx(std::log2(std::max(v[c], 1e-10)));
        v = glm::inverse(inset) * v;
        return each({v.x, v.y, v.z},
                    [](double display) { return std::pow(std::clamp(display, 0.0, 1.0), 2.2); });
    });
}

TEST_P(PostTest, CurvesGrowAndEndInWhite) {
    std::vector<glm::vec4> colors;
    colors.reserve(600);
    for (int i = 0; i < 600; ++i) colors.emplace_back(glm::vec3(std::exp2(-16 + 0.06f * float(i))), 1);
    for (int i = 0; i < tonemap_count; ++i) {
        const auto pictures = display(colors, {.tonemap = Tonemap(i)});
        for (size_t j = 1; j < pictures.size(); ++j)
            ASSERT_GE(pictures[j][1], pictures[j - 1][1]) << to_string(Tonemap(i)) << " at " << colors[j].x;
        EXPECT_GE(pictures.back()[1], 254) << to_string(Tonemap(i));
        EXPECT_LE(pictures.front()[1], 1) << to_string(Tonemap(i));
    }
}

TEST_P(PostTest, BearsWhatIsNoLight) {
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<glm::vec4> colors = {glm::vec4(-1, -1, -1, 1), glm::vec4(1e30f, 1e30f, 1e30f, 1),
                                           glm::vec4(infinity, infinity, infinity, 1)};
    for (int i = 0; i < tonemap_count; ++i) {
        const auto pictures = display(colors, {.tonemap = Tonemap(i)});
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(pictures[0][c], 0) << to_string(Tonemap(i));
            EXPECT_GE(pictures[1][c], 254) << to_string(Tonemap(i));
            EXPECT_GE(pictures[2][c], 254) << to_string(Tonemap(i));
        }
    }
}

TEST_P(PostTest, ExposureIsInStopsAndBounded) {
    const std::vector<glm::vec4> gray = {glm::vec4(0.1f, 0.1f, 0.1f, 1)};
    for (const float stops : {-3.0f, -0.5f, 0.0f, 2.0f})
        EXPECT_NEAR(display(gray, {.exposure = stops})[0][0],
                    255 * srgb_encode(0.1 * std::exp2(double(stops))), 0.51);
    for (const float stops : {65.0f, -65.0f, std::numeric_limits<float>::quiet_NaN()}) {
        const auto refused = Post::create(device(), {.exposure = stops}, {1, 1});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::invalid_argument);
    }
}

TEST(Tonemap, NamesRoundTrip) {
    for (int i = 0; i < tonemap_count; ++i) EXPECT_EQ(tonemap_from_string(to_string(Tonemap(i))), Tonemap(i));
    EXPECT_FALSE(tonemap_from_string("filmic"));
}

}  // namespace
}  // namespace lumo::post
