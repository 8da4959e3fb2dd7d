// The BRDF against double precision, and the laws that it keeps.
#include "shaders/test_accuracy/brdf.hpp"

#include <cmath>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "tests/support/device_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct BrdfTest : DeviceTest {
    struct Case {
        glm::vec4 base_color_metallic;
        glm::vec4 to_eye_roughness;
        glm::vec4 to_light;
    };

    std::vector<glm::vec4> evaluate(const std::vector<Case>& cases, bool lambert) {
        auto pipeline = compute<shaders::test_accuracy::brdf>({.lambert = lambert});
        const rhi::Buffer input = buffer_with(cases);
        const rhi::Buffer output = buffer(cases.size() * sizeof(glm::vec4));
        run(pipeline, {input.slice(), output.slice()}, {uint32_t(cases.size())},
            {rhi::groups_for(uint32_t(cases.size()), 64)});
        return contents<glm::vec4>(output);
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, BrdfTest, both_apis, api_name);

glm::vec4 direction(double cosine, double azimuth) {
    const double sine = std::sqrt(1 - cosine * cosine);
    return glm::vec4(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine, 0);
}

/// Karis 2013 and Burley 2012 from their texts: BRDF times cosine, for one channel.
struct Terms {
    double diffuse;
    double specular;
};
Terms expected(const BrdfTest::Case& c, int channel) {
    const glm::dvec3 l(c.to_light), v(c.to_eye_roughness);
    const glm::dvec3 h = glm::normalize(l + v);
    const double base = double(c.base_color_metallic[channel]), metallic = double(c.base_color_metallic.a);
    const double roughness = std::max(double(c.to_eye_roughness.w), 0.045);
    const double n_l = l.z, n_v = std::max(v.z, 1e-4), n_h = h.z, v_h = glm::dot(v, h);
    const double fd90 = 0.5 + 2 * v_h * v_h * roughness;
    const double diffuse = base * (1 - metallic) / M_PI * (1 + (fd90 - 1) * std::pow(1 - n_l, 5)) *
                           (1 + (fd90 - 1) * std::pow(1 - n_v, 5));
    const double alpha = roughness * roughness;
    const double tangent_squared = (1 - n_h * n_h) / (n_h * n_h);
    const double d =
        1 / (M_PI * alpha * alpha * std::pow(n_h, 4) * std::pow(1 + tangent_squared / (alpha * alpha), 2));
    const double k = std::pow(roughness + 1, 2) / 8;
    const auto g1 = [k](double n) { return n / (n * (1 - k) + k); };
    const double f0 = 0.04 * (1 - metallic) + base * metallic;
    const double f = f0 + (1 - f0) * std::pow(1 - v_h, 5);
    return {diffuse * n_l, d * f * g1(n_l) * g1(n_v) / (4 * n_l * n_v) * n_l};
}

TEST_P(BrdfTest, MatchesDoublePrecision) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Case> cases;
    for (int i = 0; i < 20000; ++i) {
        cases.push_back({glm::vec4(uniform(random), uniform(random), uniform(random), uniform(random)),
                         direction(0.01 + 0.99 * uniform(random), 2 * M_PI * uniform(random)),
                         direction(0.01 + 0.99 * uniform(random), 2 * M_PI * uniform(random))});
        // Half of the lights near the mirror direction, where the highlight is.
        if (i % 2) {
            const glm::vec4& v = cases.back().to_eye_roughness;
            cases.back().to_light = glm::vec4(
                glm::normalize(glm::dvec3(-v.x, -v.y, v.z) +
                               0.02 * glm::dvec3(uniform(random), uniform(random), uniform(random))),
                0);
        }
        cases.back().to_eye_roughness.w = float(uniform(random));
    }
    const std::vector<glm::vec4> results = evaluate(cases, false);
    for (size_t i = 0; i < cases.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const Terms terms = expected(cases[i], c);
            const double wanted = terms.diffuse + terms.specular;
            // A highlight of width alpha turns an angle's rounding, 1e-7, into 1e-7 / alpha.
            const double roughness = std::max(double(cases[i].to_eye_roughness.w), 0.045);
            const double tolerance = 2e-6 + 1e-6 / (roughness * roughness);
            ASSERT_NEAR(results[i][c], wanted, tolerance * wanted + 1e-7) << "case " << i;
        }
    }
}

TEST_P(BrdfTest, IsReciprocal) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Case> cases, swapped;
    for (int i = 0; i < 5000; ++i) {
        const float roughness = float(0.2 + 0.8 * uniform(random));
        Case c{glm::vec4(0.8, 0.5, 0.2, uniform(random)),
               direction(0.05 + 0.95 * uniform(random), 2 * M_PI * uniform(random)),
               direction(0.05 + 0.95 * uniform(random), 2 * M_PI * uniform(random))};
        Case s{c.base_color_metallic, c.to_light, c.to_eye_roughness};
        c.to_eye_roughness.w = s.to_eye_roughness.w = roughness;
        cases.push_back(c);
        swapped.push_back(s);
    }
    const auto forward = evaluate(cases, false), backward = evaluate(swapped, false);
    for (size_t i = 0; i < cases.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float f = forward[i][c] / cases[i].to_light.z, b = backward[i][c] / swapped[i].to_light.z;
            ASSERT_NEAR(f, b, 2e-5f * f) << "case " << i;
        }
}

TEST_P(BrdfTest, ReflectsNothingFromBelow) {
    std::vector<Case> cases;
    for (int i = 0; i <= 20; ++i)
        cases.push_back(
            {glm::vec4(1), direction(0.05 * i, 0) + glm::vec4(0, 0, 0, 0.5), direction(-0.05 * i, 1)});
    for (const bool lambert : {false, true})
        for (const glm::vec4& result : evaluate(cases, lambert)) EXPECT_EQ(result, glm::vec4(0));
}

/// Part of the light from all around that goes to one eye; the rule is of midpoints over light directions about
/// the mirror direction's half vectors, by GGX's own distribution, so that narrow highlights are not missed.
TEST_P(BrdfTest, ReflectsNoMoreThanItReceives) {
    constexpr int grid = 256;
    for (const float roughness : {0.05f, 0.1f, 0.25f, 0.5f, 0.75f, 1.0f}) {
        for (const double n_v : {0.05, 0.2, 0.5, 0.8, 1.0}) {
            const glm::dvec3 v(direction(n_v, 0));
            std::vector<Case> cases;
            std::vector<double> solid_angles;
            const double alpha = double(roughness) * double(roughness);
            for (int i = 0; i < grid; ++i)
                for (int j = 0; j < grid; ++j) {
                    const double u = (i + 0.5) / grid, azimuth = 2 * M_PI * (j + 0.5) / grid;
                    const double cosine = std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u));
                    const glm::dvec3 h(direction(cosine, azimuth));
                    const glm::dvec3 l = 2 * glm::dot(v, h) * h - v;
                    if (l.z <= 1e-6 || glm::dot(v, h) <= 1e-6) continue;
                    Case c{glm::vec4(1), glm::vec4(v, roughness), glm::vec4(l, 0)};
                    cases.push_back(c);
                    const double d =
                        1 / (M_PI * alpha * alpha * std::pow(cosine, 4) *
                             std::pow(1 + (1 - cosine * cosine) / (cosine * cosine * alpha * alpha), 2));
                    solid_angles.push_back(4 * glm::dot(v, h) / (d * cosine) / (grid * grid));
                }
            const auto results = evaluate(cases, false);
            double reflected = 0, exact = 0;
            for (size_t i = 0; i < cases.size(); ++i) {
                reflected += double(results[i].x) * solid_angles[i];
                exact += expected(cases[i], 0).specular * solid_angles[i];
            }
            // A white metal: specular alone.
            EXPECT_LE(reflected, 1.0) << "roughness " << roughness << ", n·v " << n_v;
            EXPECT_NEAR(reflected, exact, 1e-4) << "roughness " << roughness << ", n·v " << n_v;
        }
    }
}

/// Burley's own gains and losses, by roughness and n·v, as shaders/common/brdf.glsl states them.
const std::map<std::pair<float, double>, double> burley_albedo = {
    {{0.5f, 0.1}, 1.0235}, {{0.5f, 0.5}, 1.0083}, {{0.5f, 1.0}, 1.0060},
    {{1.0f, 0.1}, 1.3801}, {{1.0f, 0.5}, 1.0569}, {{1.0f, 1.0}, 1.0357}};

/// In a white furnace a white Lambertian surface is as bright as its surroundings; Burley's by itself gains or loses
/// the few percent that its model is known to.
TEST_P(BrdfTest, DiffuseAlbedoInAFurnace) {
    constexpr int grid = 128;
    for (const bool lambert : {true, false}) {
        for (const float roughness : {0.5f, 1.0f}) {
            for (const double n_v : {0.1, 0.5, 1.0}) {
                std::vector<Case> cases;
                for (int i = 0; i < grid; ++i)
                    for (int j = 0; j < grid; ++j)
                        cases.push_back({glm::vec4(1, 0.5, 0, 0),
                                         direction(n_v, 0) + glm::vec4(0, 0, 0, roughness),
                                         direction((i + 0.5) / grid, 2 * M_PI * (j + 0.5) / grid)});
                const auto results = evaluate(cases, lambert);
                double white = 0, black = 0, exact = 0;
                for (size_t i = 0; i < cases.size(); ++i) {
                    white += double(results[i].x) * 2 * M_PI / double(cases.size());
                    black += double(results[i].z) * 2 * M_PI / double(cases.size());
                    exact += expected(cases[i], 0).diffuse * 2 * M_PI / double(cases.size());
                }
                if (lambert) {
                    EXPECT_NEAR(white, 1, 1e-5);
                } else {
                    // The specular term is the same for both channels.
                    EXPECT_NEAR(white - black, exact, 1e-4) << "roughness " << roughness << ", n·v " << n_v;
                    const double known = burley_albedo.at({roughness, n_v});
                    EXPECT_NEAR(white - black, known, 0.002) << "roughness " << roughness << ", n·v " << n_v;
                }
            }
        }
    }
}

}  // namespace
}  // namespace lumo
