// The numbers that the atmosphere's tables are made with, against closed forms and sums of many terms.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "techniques/atmosphere/quadrature.hpp"

namespace lumo::atmosphere {
namespace {

constexpr double pi = std::numbers::pi;

double cornette_shanks(double nu, double g) {
    const double base = 1 + g * g - 2 * g * nu;
    return 3 / (8 * pi) * (1 - g * g) / (2 + g * g) * (1 + nu * nu) / (base * std::sqrt(base));
}

/// The integral over cosines from -1 to 1.
template <class F>
double over_cosines(const F& f) {
    double sum = 0;
    const std::vector<Node> rule = gauss_legendre(64);
    for (int piece = 0; piece < 8; ++piece)
        for (const Node& node : rule) sum += 0.25 * node.weight * f(-1 + 0.25 * (piece + node.x));
    return sum;
}

TEST(AtmosphereQuadrature, GaussIsExactForPolynomialsOfTwiceTheDegree) {
    for (const uint32_t count : {1u, 4u, 7u, 16u, 43u}) {
        const std::vector<Node> rule = gauss_legendre(count);
        for (uint32_t power = 0; power < 2 * count; ++power) {
            double sum = 0;
            for (const Node& node : rule) sum += node.weight * std::pow(node.x, power);
            EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-13) << count << ", x^" << power;
        }
        for (uint32_t i = 1; i < count; ++i) EXPECT_LT(rule[i - 1].x, rule[i].x);
    }
}

TEST(AtmosphereQuadrature, InterpolationIsExactForPolynomialsOfLowerDegree) {
    for (const uint32_t count : {1u, 3u, 8u, 24u}) {
        const std::vector<Node> rule = gauss_legendre(count);
        for (const double x : {0.0, 0.01, 0.4, rule.back().x, 1.0}) {
            const std::vector<double> values = interpolation(rule, x);
            ASSERT_EQ(values.size(), count);
            for (uint32_t power = 0; power < count; ++power) {
                double sum = 0;
                for (uint32_t i = 0; i < count; ++i) sum += values[i] * std::pow(rule[i].x, power);
                EXPECT_NEAR(sum, std::pow(x, power), 1e-11) << count << ", " << x << "^" << power;
            }
        }
    }
}

TEST(AtmosphereQuadrature, MomentsAreIntegralsOfThePhaseFunction) {
    for (const double g : {-0.5, 0.0, 0.3, 0.8}) {
        const std::vector<double> moments = cornette_shanks_moments(g, 20);
        EXPECT_NEAR(moments[0], 1, 1e-12);
        for (uint32_t l = 0; l <= 20; ++l) {
            const double integral = over_cosines(
                [&](double nu) { return 2 * pi * cornette_shanks(nu, g) * std::legendre(l, nu); });
            EXPECT_NEAR(moments[l], integral, 1e-10) << g << ", " << l;
        }
    }
}

TEST(AtmosphereQuadrature, HarmonicsAreOrthonormal) {
    for (const uint32_t m : {0u, 1u, 5u}) {
        for (uint32_t a = m; a <= 12; ++a) {
            for (uint32_t b = m; b <= 12; ++b) {
                // The integral over azimuths of the squared cosine is pi, or 2 pi at m = 0.
                const double product = (m == 0 ? 2 : 1) * pi * over_cosines([&](double mu) {
                                           const std::vector<double> p = harmonics(m, 12, mu);
                                           return p[a - m] * p[b - m];
                                       });
                EXPECT_NEAR(product, a == b ? 1 : 0, 1e-11) << m << ", " << a << ", " << b;
            }
        }
    }
}

/// What is left out of the lower degrees is all of the rest.
TEST(AtmosphereQuadrature, LowDegreesAndPeakAddUp) {
    const double g = 0.8;
    const std::vector<double> moments = cornette_shanks_moments(g, 400);
    for (const double nu : {-1.0, -0.3, 0.5, 0.95, 1.0}) {
        double low = 0;
        for (uint32_t l = 0; l <= 5; ++l) low += (2 * l + 1) / (4 * pi) * moments[l] * std::legendre(l, nu);
        EXPECT_NEAR(low + peak(moments, 5, 1, nu), cornette_shanks(nu, g), 1e-8 * cornette_shanks(1, g))
            << nu;
    }
    // A convolution multiplies moments: below the peak there are none.
    for (const uint32_t power : {2u, 5u}) {
        const double none =
            over_cosines([&](double nu) { return peak(moments, 5, power, nu) * std::legendre(3, nu); });
        EXPECT_NEAR(none, 0, 1e-12);
        const double sixth =
            over_cosines([&](double nu) { return peak(moments, 5, power, nu) * std::legendre(6, nu); });
        EXPECT_NEAR(2 * pi * sixth, std::pow(moments[6], power), 1e-11);
    }
}

TEST(AtmosphereQuadrature, PeakIrradianceIsTheIntegralOfThePeak) {
    const std::vector<double> moments = cornette_shanks_moments(0.7, 60);
    const std::vector<Node> rule = gauss_legendre(40);
    for (const double mu_peak : {-0.6, 0.0, 0.3, 1.0}) {
        for (const uint32_t power : {1u, 3u}) {
            double sum = 0;
            for (const Node& cosine : rule) {
                for (int k = 0; k < 80; ++k) {
                    const double sines = std::sqrt((1 - cosine.x * cosine.x) * (1 - mu_peak * mu_peak));
                    const double nu = cosine.x * mu_peak + sines * std::cos(2 * pi * k / 80);
                    sum += 2 * pi / 80 * cosine.weight * cosine.x * peak(moments, 3, power, nu);
                }
            }
            EXPECT_NEAR(peak_irradiance(moments, 3, power, mu_peak), sum, 1e-5) << mu_peak << ", " << power;
        }
    }
}

}  // namespace
}  // namespace lumo::atmosphere
