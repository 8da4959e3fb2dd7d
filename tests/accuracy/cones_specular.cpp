// Indirect light of the specular lobe: what a constant environment must give, and a rough metal before a lit wall
// against double precision.
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>
#include <random>

#include "scene/builtin/builtin.hpp"
#include "techniques/cones/specular.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

/// The specular BRDF of shaders/common/brdf.glsl without Fresnel, times the cosine of the light.
double lobe(glm::dvec3 view, glm::dvec3 light, double roughness) {
    if (light.z <= 0) return 0;
    const double alpha = roughness * roughness, k = (roughness + 1) * (roughness + 1) / 8;
    const glm::dvec3 half = glm::normalize(view + light);
    const double d = half.z * half.z * (alpha * alpha - 1) + 1;
    const double distribution = alpha * alpha / (glm::pi<double>() * d * d);
    const double visibility = 0.25 / ((light.z * (1 - k) + k) * (view.z * (1 - k) + k));
    return distribution * visibility * light.z;
}

TEST(SpecularReflectance, IsTheIntegralOfTheLobe) {
    constexpr uint32_t side = 8;
    const std::vector<glm::vec2> table = cones::specular_reflectance(side);
    ASSERT_EQ(table.size(), size_t(side * side));
    for (uint32_t y = 3; y < side; ++y)  // narrower lobes slip between the directions
        for (uint32_t x = 1; x < side; ++x) {
            const double n_v = x / (side - 1.0), roughness = y / (side - 1.0);
            const glm::dvec3 view(std::sqrt(1 - n_v * n_v), 0, n_v);
            constexpr int n = 300;
            glm::dvec2 sum(0);
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const double z = (i + 0.5) / n, azimuth = glm::pi<double>() * (j + 0.5) / n;
                    const double s = std::sqrt(1 - z * z);
                    const glm::dvec3 light(s * std::cos(azimuth), s * std::sin(azimuth), z);
                    const double fresnel = std::pow(1 - glm::dot(view, glm::normalize(view + light)), 5);
                    sum += glm::dvec2(1 - fresnel, fresnel) * lobe(view, light, roughness);
                }
            sum *= glm::two_pi<double>() / (n * n);
            EXPECT_NEAR(double(table[y * side + x].x), sum.x, 0.01) << n_v << " " << roughness;
            EXPECT_NEAR(double(table[y * side + x].y), sum.y, 0.01) << n_v << " " << roughness;
        }
}

struct SpecularTest : DeviceTest {
    scene::ImageF specular(const scene::Scene& scene, uint32_t resolution, rhi::Extent size) {
        frame::Settings settings{.size = size, .layers = {frame::Layer::specular}};
        settings.voxels.resolution = resolution;
        return must(frame::render(device(), scene, scene::default_camera(scene), settings)).layers[0].linear;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, SpecularTest, both_apis, api_name);

/// A metal plate in an environment of radiance 1, seen from straight above: its reflectance, from mirror to matt.
TEST_P(SpecularTest, PlateInAConstantEnvironment) {
    for (const float roughness : {0.0f, 0.2f, 0.5f, 0.8f, 1.0f}) {
        scene::Scene scene;
        add(scene, scene::builtin::box({-1, -0.1f, -1}, {1, 0, 1}),
            {.base_color = {0.9f, 0.6f, 0.3f, 1}, .metallic = 1, .roughness = roughness});
        scene.environment_radiance = glm::vec3(1);
        scene.cameras.push_back({.position = {0, 20, 0}, .target = {0, 0, 0}, .vertical_fov = 0.05f});
        const scene::ImageF picture = specular(scene, 32, {16, 16});
        const double at = std::max(double(roughness), 0.045);
        // Straight above the Fresnel term adds nothing but for rough lobes.
        glm::dvec2 factors(0);
        constexpr int n = 400;
        for (int i = 0; i < n; ++i) {
            // Slopes of half vectors, so that narrow lobes are met.
            const double part = (i + 0.5) / n, alpha = at * at;
            const double cosine = std::sqrt((1 - part) / (1 + (alpha * alpha - 1) * part));
            const double n_l = 2 * cosine * cosine - 1, k = (at + 1) * (at + 1) / 8;
            if (n_l <= 0) continue;
            const double fresnel = std::pow(1 - cosine, 5);
            factors += glm::dvec2(1 - fresnel, fresnel) * (n_l / (n_l * (1 - k) + k) / n);
        }
        for (int c = 0; c < 3; ++c) {
            const double expected = double(glm::vec3(0.9f, 0.6f, 0.3f)[c]) * factors.x + factors.y;
            EXPECT_NEAR(double(picture.at(8, 8)[c]), expected, 0.02 * expected)
                << roughness << " channel " << c;
        }
    }
}

/// A metal floor beside a glowing wall, seen from above at 45 degrees toward the wall, whose mirror image has an edge: the
/// metal's roughness spreads it. Against the integral of the whole lobe.
TEST_P(SpecularTest, RoughMetalBesideAGlowingWall) {
    constexpr double wall_z = -2, wall_height = 1, half = 3;
    constexpr rhi::Extent size{8, 64};
    for (const double roughness : {0.2, 0.5, 1.0}) {
        scene::Scene scene;
        add(scene, scene::builtin::parallelogram({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}),
            {.base_color = glm::vec4(1), .metallic = 1, .roughness = float(roughness)});
        add(scene, scene::builtin::parallelogram({-half, 0, wall_z}, {2 * half, 0, 0}, {0, wall_height, 0}),
            diffuse(glm::vec3(0), glm::vec3(1)));
        const glm::dvec3 eye(0, 4, 4.5);
        scene.cameras.push_back({.position = glm::vec3(eye), .target = {0, 0, 0.5f}, .vertical_fov = 0.5f});
        frame::Settings settings{.size = size, .layers = {frame::Layer::specular, frame::Layer::depth}};
        settings.voxels.resolution = 64;
        const frame::Rendered rendered =
            must(frame::render(device(), scene, scene::default_camera(scene), settings));
        const glm::dvec3 axis = glm::normalize(glm::dvec3(0, 0, 0.5) - eye);
        const glm::dvec3 up = glm::normalize(glm::dvec3(0, 1, 0) - axis * axis.y);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> unit(0, 1);
        double squares = 0, sum = 0, truth_sum = 0;
        int rows = 0;
        // The rows above see the wall itself.
        for (uint32_t y = 4; y < size.height; y += 4, ++rows) {
            double estimate = 0, truth = 0;
            for (uint32_t i = 0; i < 4; ++i) {
                const double v = (1 - 2 * (y + i + 0.5) / size.height) * std::tan(0.25);
                const glm::dvec3 ray = axis + up * v;
                const glm::dvec3 at = eye - ray * (eye.y / ray.y);
                // Normal is +y: local z. Half vectors drawn from the distribution.
                const glm::dvec3 to_eye = glm::normalize(eye - at);
                const glm::dvec3 view(to_eye.x, to_eye.z, to_eye.y);
                const double alpha = roughness * roughness, k = (roughness + 1) * (roughness + 1) / 8;
                constexpr int samples = 1000;
                for (int s = 0; s < samples; ++s) {
                    const double part = unit(random), azimuth = glm::two_pi<double>() * unit(random);
                    const double cosine = std::sqrt((1 - part) / (1 + (alpha * alpha - 1) * part));
                    const double sine = std::sqrt(1 - cosine * cosine);
                    const glm::dvec3 h(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
                    const double v_h = glm::dot(view, h);
                    const glm::dvec3 light = 2 * v_h * h - view;
                    if (v_h <= 0 || light.z <= 0 || light.y >= 0) continue;
                    const double distance = (wall_z - at.z) / light.y;
                    if (std::abs(at.x + distance * light.x) > half || distance * light.z > wall_height)
                        continue;
                    truth += light.z * v_h / (h.z * (light.z * (1 - k) + k) * (view.z * (1 - k) + k)) /
                             samples / 4;
                }
                estimate += double(rendered.layers[0].linear.at(4, y + i)[0]) / 4;
            }
            squares += (estimate - truth) * (estimate - truth);
            sum += estimate - truth;
            truth_sum += truth;
        }
        const double rmse = std::sqrt(squares / rows) / (truth_sum / rows), bias = sum / truth_sum;
        RecordProperty(fmt::format("roughness_{}", int(10 * roughness)),
                       fmt::format("{:.3f} {:.3f}", rmse, bias));
        EXPECT_LT(rmse, 0.3) << roughness;
        EXPECT_LT(std::abs(bias), 0.12) << roughness;
    }
}

}  // namespace
}  // namespace lumo
