// The BRDF of the path tracer, the directions drawn after it, and the numbers that they are drawn with.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "reference/brdf.hpp"
#include "reference/sampler.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

glm::dvec3 direction(double cosine, double azimuth) {
    const double sine = std::sqrt(1 - cosine * cosine);
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

/// The integral over the hemisphere, finer toward the mirror direction of a grazing or narrow highlight than a plain
/// grid: midpoints in the frame about that direction, with those below the horizon left out.
template <class F>
double integral(glm::dvec3 to_eye, double alpha, const F& f) {
    const glm::dmat3 frame = frame_about({-to_eye.x, -to_eye.y, to_eye.z});
    constexpr int rings = 1200, sectors = 400;
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        // theta = alpha (e^s - 1): even where the highlight is, then ever wider.
        const double end = std::log(1 + pi / alpha), s = end * (i + 0.5) / rings;
        const double theta = alpha * (std::exp(s) - 1), width = alpha * std::exp(s) * end / rings;
        for (int j = 0; j < sectors; ++j) {
            const double phi = 2 * pi * (j + 0.5) / sectors;
            const glm::dvec3 l = frame * direction(std::cos(theta), phi);
            if (l.z > 0) sum += f(l) * std::sin(theta) * width * 2 * pi / sectors;
        }
    }
    return sum;
}

struct View {
    double roughness;
    double cosine;
};
class BrdfViews : public ::testing::TestWithParam<View> {
  protected:
    glm::dvec3 to_eye() const { return direction(GetParam().cosine, 0.7); }
    double alpha() const { return GetParam().roughness * GetParam().roughness; }
};
INSTANTIATE_TEST_SUITE_P(Roughness, BrdfViews,
                         ::testing::Values(View{0.1, 1}, View{0.1, 0.5}, View{0.3, 0.8}, View{0.3, 0.1},
                                           View{0.5, 0.5}, View{1, 1}, View{1, 0.5}, View{1, 0.1}));

TEST_P(BrdfViews, DrawsByItsDensity) {
    const Brdf brdf = make_brdf({0.5, 0.5, 0.5}, 0.5, GetParam().roughness);
    for (const double share : {0.0, 0.5, 1.0}) {
        const DirectionSampler directions(brdf, to_eye(), share);
        // What is drawn below the horizon is not part of the density.
        constexpr int draws = 20000;
        double above = 0, cosines = 0, eastward = 0;
        for (int i = 0; i < draws; ++i) {
            const Sampler sampler(3, uint32_t(i));
            const glm::dvec3 l = directions.draw(sampler.number(0), sampler.pair(1));
            ASSERT_NEAR(glm::length(l), 1, 1e-9);
            if (l.z <= 0) continue;
            above += 1.0 / draws;
            cosines += l.z / draws;
            eastward += l.x / draws;
        }
        const auto density = [&](glm::dvec3 l) { return directions.density(l); };
        EXPECT_NEAR(integral(to_eye(), alpha(), density), above, 0.005) << share;
        EXPECT_NEAR(integral(to_eye(), alpha(), [&](glm::dvec3 l) { return l.z * density(l); }), cosines,
                    0.005);
        EXPECT_NEAR(integral(to_eye(), alpha(), [&](glm::dvec3 l) { return l.x * density(l); }), eastward,
                    0.005);
    }
}

TEST_P(BrdfViews, EstimatesItsOwnIntegral) {
    const Brdf brdf = make_brdf({0.8, 0.5, 0.2}, 0.3, GetParam().roughness);
    const DirectionSampler directions(brdf, to_eye(), specular_share(brdf, to_eye()));
    glm::dvec3 diffuse(0), specular(0);
    constexpr int draws = 40000;
    for (int i = 0; i < draws; ++i) {
        const Sampler sampler(4, uint32_t(i));
        const glm::dvec3 l = directions.draw(sampler.number(0), sampler.pair(1));
        const double density = directions.density(l);
        if (density == 0) continue;
        const Reflected reflected = reflect(brdf, to_eye(), l);
        diffuse += reflected.diffuse / density / double(draws);
        specular += reflected.specular / density / double(draws);
    }
    for (int c = 0; c < 3; ++c) {
        const double d =
            integral(to_eye(), alpha(), [&](glm::dvec3 l) { return reflect(brdf, to_eye(), l).diffuse[c]; });
        const double s =
            integral(to_eye(), alpha(), [&](glm::dvec3 l) { return reflect(brdf, to_eye(), l).specular[c]; });
        EXPECT_NEAR(diffuse[c], d, 0.01 * d);
        EXPECT_NEAR(specular[c], s, 0.01 * s);
    }
}

TEST_P(BrdfViews, KeepsItsEnergy) {
    const Brdf metal = make_brdf(glm::dvec3(1), 1, GetParam().roughness);
    const double specular =
        integral(to_eye(), alpha(), [&](glm::dvec3 l) { return reflect(metal, to_eye(), l).specular.x; });
    EXPECT_LE(specular, 1.001);
    EXPECT_GT(specular, 0.2);
    EXPECT_EQ(reflect(metal, to_eye(), direction(0.5, 1)).diffuse, glm::dvec3(0));
}

// The figures that shaders/common/brdf.glsl states.
TEST(Brdf, OfBurleyGainsWhatTheModelGains) {
    const struct {
        double roughness, cosine, expected;
    } cases[] = {{1, 1, 1.04},   {1, 0.5, 1.06},   {1, 0.1, 1.38},
                 {0.5, 1, 1.01}, {0.5, 0.5, 1.01}, {0.5, 0.1, 1.02}};
    for (const auto& c : cases) {
        const Brdf white = make_brdf(glm::dvec3(1), 0, c.roughness);
        const glm::dvec3 to_eye = direction(c.cosine, 0);
        const double reflected =
            integral(to_eye, 1, [&](glm::dvec3 l) { return reflect(white, to_eye, l).diffuse.x; });
        EXPECT_NEAR(reflected, c.expected, 0.006) << c.roughness << " " << c.cosine;
    }
}

TEST(Brdf, IsReciprocalAndNothingFromBelow) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.05, 1);
    for (int i = 0; i < 1000; ++i) {
        const Brdf brdf =
            make_brdf({uniform(random), uniform(random), uniform(random)}, uniform(random), uniform(random));
        const glm::dvec3 v = direction(uniform(random), 6 * uniform(random));
        const glm::dvec3 l = direction(uniform(random), 6 * uniform(random));
        const Reflected there = reflect(brdf, v, l), back = reflect(brdf, l, v);
        for (int c = 0; c < 3; ++c) {
            const double f = (there.diffuse[c] + there.specular[c]) / l.z;
            ASSERT_NEAR(f, (back.diffuse[c] + back.specular[c]) / v.z, 1e-9 * f);
        }
        const Reflected below = reflect(brdf, v, {l.x, l.y, -l.z});
        ASSERT_EQ(below.diffuse + below.specular, glm::dvec3(0));
        ASSERT_EQ(DirectionSampler(brdf, v, 0.5).density({l.x, l.y, -l.z}), 0);
    }
}

TEST(Brdf, OfLambertIsConstant) {
    const Brdf grey = lambertian(glm::dvec3(0.5));
    for (const double cosine : {0.01, 0.3, 1.0}) {
        const Reflected r = reflect(grey, direction(0.2, 1), direction(cosine, 2));
        EXPECT_NEAR(r.diffuse.x, 0.5 / pi * cosine, 1e-12);
        EXPECT_EQ(r.specular.x, 0);
    }
    EXPECT_EQ(specular_share(grey, direction(0.2, 1)), 0);
}

// -- numbers ----------------------------------------------------------------------------------------------

// Every power of two of samples has one in each cell of every elementary grid: what makes Sobol's pairs converge.
TEST(Sampler, FillsEveryElementaryGrid) {
    constexpr uint32_t log_count = 8, count = 1u << log_count;
    for (const uint32_t dimension : {0u, 1u, 17u}) {
        for (uint32_t columns = 0; columns <= log_count; ++columns) {
            std::set<std::pair<uint32_t, uint32_t>> cells;
            for (uint32_t i = 0; i < count; ++i) {
                const glm::dvec2 p = Sampler(99, i).pair(dimension);
                cells.insert(
                    {uint32_t(p.x * (1u << columns)), uint32_t(p.y * (1u << (log_count - columns)))});
            }
            EXPECT_EQ(cells.size(), count) << dimension << " " << columns;
        }
    }
}

TEST(Sampler, IsUniformOverStreamsAndPairsOfDimensions) {
    // The first sample alone, over many streams: what an unbiased estimate leans on. Cells of two dimensions of
    // different pairs, and of one pair.
    constexpr int streams = 64000, side = 8;
    for (const bool same_pair : {false, true}) {
        std::array<int, side * side> cells{};
        for (uint32_t stream = 0; stream < streams; ++stream) {
            const Sampler sampler(hash(stream, 5), 3);
            const glm::dvec2 p =
                same_pair ? sampler.pair(2) : glm::dvec2(sampler.number(2), sampler.number(3));
            ++cells[size_t(int(p.x * side) + side * int(p.y * side))];
        }
        double chi_squared = 0;
        for (const int found : cells) chi_squared += std::pow(found - streams / 64.0, 2) / (streams / 64.0);
        EXPECT_LT(chi_squared, 63 + 4 * std::sqrt(2 * 63.0));
    }
}

TEST(Sampler, DimensionsOfOnePixelAreNotCorrelated) {
    constexpr uint32_t count = 4096;
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const Sampler sampler(7, i);
        sum += (sampler.number(4) - 0.5) * (sampler.number(5) - 0.5);
    }
    // Its standard deviation is at most 1/12 / 64 for independent numbers.
    EXPECT_LT(std::abs(sum / count), 3.0 / 12 / 64);
}

TEST(Sampler, FrameIsRightHandedAboutAnyNormal) {
    for (const glm::dvec3 n : {glm::dvec3(0, 0, 1), {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.6, 0, -0.8}}) {
        const glm::dmat3 frame = frame_about(n);
        EXPECT_NEAR(glm::determinant(frame), 1, 1e-12);
        EXPECT_NEAR(glm::length(frame[2] - n), 0, 1e-12);
        EXPECT_NEAR(glm::length(glm::transpose(frame) * frame[0] - glm::dvec3(1, 0, 0)), 0, 1e-12);
    }
}

}  // namespace
}  // namespace lumo::reference
