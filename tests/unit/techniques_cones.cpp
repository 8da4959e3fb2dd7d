// The distribution of cones, for every count.
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "techniques/cones/distribution.hpp"

namespace lumo::cones {
namespace {

struct DistributionTest : testing::TestWithParam<int> {
    Distribution distribution = distribute(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Counts, DistributionTest, testing::Range(1, max_cones + 1));

TEST_P(DistributionTest, DirectionsAreUnitVectorsAboveTheSurface) {
    ASSERT_EQ(distribution.cones.size(), size_t(GetParam()));
    for (const Cone& cone : distribution.cones) {
        EXPECT_NEAR(glm::length(glm::dvec3(cone.direction)), 1, 1e-6);
        // The whole circle is above the horizon.
        EXPECT_LE(std::acos(std::min(double(cone.direction.z), 1.0)) + double(distribution.half_angle),
                  glm::half_pi<double>() + 1e-4);
    }
}

TEST_P(DistributionTest, CirclesDoNotOverlap) {
    for (size_t i = 0; i < distribution.cones.size(); ++i)
        for (size_t j = 0; j < i; ++j) {
            const double cosine = glm::dot(glm::dvec3(distribution.cones[i].direction),
                                           glm::dvec3(distribution.cones[j].direction));
            EXPECT_GE(std::acos(std::clamp(cosine, -1.0, 1.0)), 2 * double(distribution.half_angle) - 1e-4)
                << i << " and " << j;
        }
}

TEST_P(DistributionTest, WeightsArePositiveAndAddToOne) {
    double sum = 0;
    for (const Cone& cone : distribution.cones) {
        EXPECT_GT(cone.weight, 0);
        sum += double(cone.weight);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
}

/// Irradiance of light that grows linearly toward the zenith: integral of cos² over the hemisphere is 2 pi / 3, which
/// is 2/3 of a constant light's. Fewer than five cones do not resolve it.
TEST(Distribution, IntegratesTheCosineFromFiveConesOn) {
    for (int n = 5; n <= max_cones; ++n) {
        double sum = 0;
        for (const Cone& cone : distribute(n).cones) sum += double(cone.weight) * double(cone.direction.z);
        EXPECT_NEAR(sum, 2.0 / 3, 0.08) << n;
    }
}

TEST(Distribution, GetsNarrowerWithTheCount) {
    for (int n = 2; n <= max_cones; ++n)
        EXPECT_LE(distribute(n).half_angle, distribute(n - 1).half_angle + 1e-6f) << n;
}

TEST(Distribution, TakesCountsFromTheRange) {
    EXPECT_EQ(distribute(0).cones.size(), 1u);
    EXPECT_EQ(distribute(-5).cones.size(), 1u);
    EXPECT_EQ(distribute(1000).cones.size(), size_t(max_cones));
}

}  // namespace
}  // namespace lumo::cones
