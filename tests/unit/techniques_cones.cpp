// Sets of cones, for every count and both kinds of apertures, and the table of their errors in docs/cones.md.
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>

#include "techniques/cones/distribution.hpp"

namespace lumo::cones {
namespace {

double polar_angle(const Cone& cone) { return std::acos(std::min(double(cone.direction.z), 1.0)); }

double coverage(const Distribution& distribution) {
    double sum = 0;
    for (const Cone& cone : distribution.cones) sum += 1 - std::cos(double(cone.half_angle));
    return sum;
}

struct DistributionTest : testing::TestWithParam<std::tuple<int, Apertures>> {
    int count = std::get<0>(GetParam());
    Distribution distribution = distribute({.count = count, .apertures = std::get<1>(GetParam())});
};
INSTANTIATE_TEST_SUITE_P(Sets, DistributionTest,
                         testing::Combine(testing::Range(1, max_cones + 1),
                                          testing::Values(Apertures::uniform, Apertures::nonuniform)),
                         [](const auto& parameters) {
                             return fmt::format("{}_{}", std::get<0>(parameters.param),
                                                std::get<1>(parameters.param) == Apertures::uniform
                                                    ? "uniform"
                                                    : "nonuniform");
                         });

TEST_P(DistributionTest, WholeConesAreAboveTheHorizon) {
    ASSERT_EQ(distribution.cones.size(), size_t(count));
    for (const Cone& cone : distribution.cones) {
        EXPECT_NEAR(glm::length(glm::dvec3(cone.direction)), 1, 1e-6);
        EXPECT_GT(cone.half_angle, 0);
        EXPECT_LE(polar_angle(cone) + double(cone.half_angle), glm::half_pi<double>() + 1e-4);
    }
}

TEST_P(DistributionTest, ConesDoNotOverlap) {
    for (size_t i = 0; i < distribution.cones.size(); ++i)
        for (size_t j = 0; j < i; ++j) {
            const Cone &a = distribution.cones[i], &b = distribution.cones[j];
            const double cosine = glm::dot(glm::dvec3(a.direction), glm::dvec3(b.direction));
            EXPECT_GE(std::acos(std::clamp(cosine, -1.0, 1.0)),
                      double(a.half_angle) + double(b.half_angle) - 1e-4)
                << i << " and " << j;
        }
}

/// So that a constant environment gives exactly its irradiance.
TEST_P(DistributionTest, WeightsAreNotNegativeAndAddToOne) {
    double sum = 0;
    for (const Cone& cone : distribution.cones) {
        EXPECT_GE(cone.weight, 0);
        sum += double(cone.weight);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST_P(DistributionTest, ConesOfARingAreAlike) {
    for (const Cone& a : distribution.cones)
        for (const Cone& b : distribution.cones) {
            const bool alike = a.half_angle == b.half_angle && a.weight == b.weight;
            EXPECT_TRUE(alike || std::abs(a.direction.z - b.direction.z) > 1e-3f);
            if (std::get<1>(GetParam()) == Apertures::uniform) {
                EXPECT_EQ(a.half_angle, b.half_angle);
            }
        }
}

/// Each place has as many cones as are asked for; all are of one spiral.
TEST_P(DistributionTest, PlacesOfAPatternShareTheHemisphere) {
    const Distribution pattern =
        distribute_in_pattern({.count = count, .apertures = std::get<1>(GetParam())});
    ASSERT_EQ(pattern.sets, places);
    ASSERT_EQ(pattern.cones.size(), size_t(places * count));
    glm::dvec3 sum(0);
    for (const Cone& cone : pattern.cones) {
        EXPECT_NEAR(glm::length(glm::dvec3(cone.direction)), 1, 1e-6);
        EXPECT_NEAR(cone.weight, 1 / double(count), 1e-6);
        EXPECT_GT(cone.half_angle, 0);
        EXPECT_LE(polar_angle(cone) + double(cone.half_angle), glm::half_pi<double>() + 1e-4);
        sum += glm::dvec3(cone.direction) / double(pattern.cones.size());
    }
    // The mean of directions that are spread by the cosine; few cones are wide, and more of them are moved up.
    const double moved = 0.12 / count + 0.01;
    EXPECT_NEAR(sum.x, 0, 0.03);
    EXPECT_NEAR(sum.y, 0, 0.03);
    EXPECT_NEAR(sum.z, 2.0 / 3 + moved / 2, moved / 2 + 0.01);
    for (int set = 0; set < places; ++set) {
        double highest = 0, lowest = 1, least_possible = 0;
        for (int i = 0; i < count; ++i) {
            const double z = double(pattern.cones[size_t(set * count + i)].direction.z);
            highest = std::max(highest, z);
            lowest = std::min(lowest, z);
            least_possible =
                std::max(least_possible, std::sin(double(pattern.cones[size_t(set * count + i)].half_angle)));
        }
        // One in each ring of the same irradiance.
        EXPECT_GE(highest, std::sqrt(1 - 1.0 / count) - 1e-6);
        EXPECT_LE(lowest, std::max(std::sqrt(1.0 / count), least_possible) + 1e-6);
    }
}

TEST(Distribution, NonuniformConesFillMore) {
    int more = 0;
    for (int n = 1; n <= max_cones; ++n) {
        const double uniform = coverage(distribute({.count = n}));
        const double nonuniform = coverage(distribute({.count = n, .apertures = Apertures::nonuniform}));
        EXPECT_GE(nonuniform, uniform - 1e-5) << n;
        more += nonuniform > uniform + 1e-3;
    }
    EXPECT_GT(more, 20);
}

TEST(Distribution, BothKindsAgreeAtThreeCones) {
    const Distribution a = distribute({.count = 3});
    const Distribution b = distribute({.count = 3, .apertures = Apertures::nonuniform});
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(glm::distance(a.cones[i].direction, b.cones[i].direction), 0, 1e-4f);
        EXPECT_NEAR(a.cones[i].half_angle, b.cones[i].half_angle, 1e-4f);
        EXPECT_NEAR(a.cones[i].weight, b.cones[i].weight, 1e-5f);
    }
    // Three circles that touch one another and the horizon: tan of the half-angle is sin of 60 degrees.
    EXPECT_NEAR(std::tan(a.cones[0].half_angle), std::sqrt(0.75), 1e-4);
}

TEST(Distribution, TakesCountsFromTheRange) {
    EXPECT_EQ(distribute({.count = 0}).cones.size(), 1u);
    EXPECT_EQ(distribute({.count = -5}).cones.size(), 1u);
    EXPECT_EQ(distribute({.count = 1000}).cones.size(), size_t(max_cones));
}

/// Of the widest cone's disk at the zenith all is inside it: the error is that of one mean over the cosine.
TEST(DirectionalErrors, OfOneConeIsKnown) {
    const DirectionalError error = directional_error(distribute({.count = 1}));
    const double seen = 1 / (2 * (1 - std::cos(glm::radians(75.0))));
    const double mean_cosine = (1 + std::cos(glm::radians(30.0))) / 2;
    EXPECT_NEAR(error.zenith, seen / mean_cosine - 1, 0.01);
}

/// What the places of a pattern see together is nearer to the cosine law than what one set sees, and more so the more
/// cones there are.
TEST(DirectionalErrors, APatternIsNearerToTheTruth) {
    for (const Apertures apertures : {Apertures::uniform, Apertures::nonuniform})
        for (const int n : {1, 2, 3, 6, 9, 18, 32}) {
            const DirectionalError plain =
                directional_error(distribute({.count = n, .apertures = apertures}));
            const DirectionalError pattern =
                directional_error(distribute_in_pattern({.count = n, .apertures = apertures}));
            EXPECT_LT(pattern.rms, plain.rms) << n;
            EXPECT_LT(pattern.rms, n < 3 ? 0.15 : n < 9 ? 0.06 : 0.03) << n;
        }
}

std::string error_table() {
    std::string table =
        "| cones | apertures | covered | zenith | horizon | RMS | max | RMS, in pattern | max, in pattern |\n"
        "|---|---|---|---|---|---|---|---|---|\n";
    for (int n = 1; n <= max_cones; ++n)
        for (const Apertures apertures : {Apertures::uniform, Apertures::nonuniform}) {
            const Distribution distribution = distribute({.count = n, .apertures = apertures});
            const DirectionalError fixed = directional_error(distribution);
            const DirectionalError pattern =
                directional_error(distribute_in_pattern({.count = n, .apertures = apertures}));
            table += fmt::format(
                "| {} | {} | {:.0f} % | {:+.0f} % | {:+.0f} % | {:.0f} % | {:.0f} % | {:.0f} % | {:.0f} % "
                "|\n",
                n, apertures == Apertures::uniform ? "uniform" : "nonuniform", 100 * coverage(distribution),
                100 * fixed.zenith, 100 * fixed.horizon, 100 * fixed.rms, 100 * fixed.max, 100 * pattern.rms,
                100 * pattern.max);
        }
    return table;
}

/// Where it differs, what the code makes is in the message: put that into the file.
TEST(DirectionalErrors, AreThoseOfTheDocument) {
    std::ifstream file(LUMO_SOURCE_DIR "/docs/cones.md");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string table = error_table();
    EXPECT_NE(text.find(table), std::string::npos) << table;
}

}  // namespace
}  // namespace lumo::cones
