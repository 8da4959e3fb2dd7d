// The sun that lights scenes against the atmosphere's truth; and the path tracer under an environment map.
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "reference/atmosphere_optics.hpp"
#include "reference/environment.hpp"
#include "reference/path_tracer.hpp"
#include "scene/sky.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = glm::pi<double>();

TEST(SunLight, IsWhatTheExactColumnsLetThrough) {
    scene::Atmosphere thick = scene::earth();
    thick.mie->scale_height_km = 0.1;
    scene::Atmosphere bare = scene::earth();
    bare.rayleigh.reset();
    bare.ozone.reset();
    for (const scene::Atmosphere& air : {scene::earth(), thick, bare}) {
        const AtmosphereOptics optics(air);
        for (const double altitude : {0.0, 0.001, 1.0, 20.0, 59.9, 60.0, 400.0, 1e4}) {
            for (const double degrees :
                 {0.0, 40.0, 85.0, 89.0, 89.9, 90.0, 90.2, 91.0, 93.0, 98.0, 108.0, 150.0}) {
                SCOPED_TRACE(fmt::format("{} km, {} degrees", altitude, degrees));
                const double mu = cos_degrees(degrees);
                const scene::Spectrum through = scene::sun_transmittance(air, altitude, mu);
                const double visible = optics.sun_visibility(altitude, mu);
                const scene::Spectrum exact = optics.transmittance(optics.sun_column(altitude, mu));
                for (size_t i = 0; i < exact.size(); ++i) {
                    ASSERT_TRUE(std::isfinite(through[i]));
                    ASSERT_NEAR(through[i], visible * exact[i], 1e-5);
                }
            }
        }
    }
}

/// Radiance by direction: brighter above, and brightest about +x.
glm::dvec3 light(glm::dvec3 d) {
    return glm::dvec3(1, 0.5, 0.25) * (0.2 + std::max(d.y, 0.0)) +
           glm::dvec3(3) * std::pow(std::max(d.x, 0.0), 40);
}

scene::Scene under_map(uint32_t rows = 128) {
    scene::Scene scene;
    scene.environment_map = {2 * rows, rows, 3, std::vector<float>(size_t(6) * rows * rows)};
    for (uint32_t y = 0; y < rows; ++y) {
        for (uint32_t x = 0; x < 2 * rows; ++x) {
            const double polar = pi * (y + 0.5) / rows, azimuth = pi * (x + 0.5) / rows;
            const glm::dvec3 value = light(
                {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)});
            for (int c = 0; c < 3; ++c) scene.environment_map.at(x, y)[c] = float(value[c]);
        }
    }
    return scene;
}

TEST(Environment, MapIsReadByDirection) {
    const scene::Scene scene = under_map();
    const Environment environment(scene);
    for (const glm::dvec3& way : {glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(1, 1e-9, -1e-9),
                                  glm::dvec3(-1, 0.3, 0), glm::dvec3(0.3, -0.7, 0.2), glm::dvec3(0, -1, 0)}) {
        const glm::dvec3 direction = glm::normalize(way);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(environment.radiance(direction)[c], light(direction)[c], 0.02);
    }
}

TEST(Environment, SamplesFollowTheirDensity) {
    const scene::Scene scene = under_map(32);
    const Environment environment(scene);
    // The integral of the radiance over the sphere, by samples and by a grid; and that of the density.
    double by_samples = 0, by_grid = 0, densities = 0;
    constexpr int texel_steps = 40'000, steps = 4, side = 400;  // as many in all
    for (int i = 0; i < texel_steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const EnvironmentSample sample = environment.sample({(i + 0.5) / texel_steps, (j + 0.5) / steps});
            ASSERT_NEAR(glm::length(sample.direction), 1, 1e-9);
            ASSERT_NEAR(environment.density(sample.direction), sample.density, 1e-6 * sample.density);
            by_samples += environment.radiance(sample.direction).g / sample.density / (side * side);
        }
    }
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double y = -1 + 2 * (i + 0.5) / side, azimuth = 2 * pi * (j + 0.5) / side;
            const double sine = std::sqrt(1 - y * y);
            const glm::dvec3 direction(sine * std::cos(azimuth), y, sine * std::sin(azimuth));
            by_grid += environment.radiance(direction).g * 4 * pi / (side * side);
            densities += environment.density(direction) * 4 * pi / (side * side);
        }
    }
    EXPECT_NEAR(densities, 1, 0.01);
    EXPECT_NEAR(by_samples, by_grid, 0.005 * by_grid);
}

TEST(Environment, ABlackMapIsNone) {
    scene::Scene scene;
    scene.environment_map = {4, 2, 3, std::vector<float>(24)};
    scene.environment_radiance = glm::vec3(2);
    const Environment environment(scene);
    EXPECT_TRUE(environment.uniform());
    EXPECT_EQ(environment.radiance({0, 1, 0}), glm::dvec3(2));
}

/// A plane that faces the brightest part receives the integral of radiance and cosine; what misses it sees the map.
TEST(Environment, LightsWhatThePathTracerSees) {
    scene::Scene scene = under_map();
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 0.4, 0.2));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), normal)),
                     up = glm::cross(normal, right);
    for (const glm::dvec2 corner : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        scene.vertices.push_back(
            {.position = glm::vec3(corner.x * right + corner.y * up), .normal = glm::vec3(normal)});
    scene.indices = {0, 1, 2, 0, 2, 3};
    scene.materials = {{.base_color = glm::vec4(1), .metallic = 0}};
    scene.meshes = {{.primitives = {{0, 6, 0}}}};
    scene.instances = {{.mesh = 0}};
    const scene::Camera camera{
        .position = glm::vec3(4.0 * normal), .target = {0, 0, 0}, .vertical_fov = 0.3f};
    const auto traced = path_trace(scene, camera,
                                   {.width = 16,
                                    .height = 16,
                                    .spp = 64,
                                    .diffuse_materials = true,
                                    .layers = {TracedLayer::irradiance, TracedLayer::emission}});
    ASSERT_TRUE(traced) << to_string(traced.error());
    glm::dvec3 expected(0);
    constexpr int side = 1000;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double cosine = std::sqrt((i + 0.5) / side), sine = std::sqrt(1 - cosine * cosine);
            const double azimuth = 2 * pi * (j + 0.5) / side;
            expected += light(right * (sine * std::cos(azimuth)) + up * (sine * std::sin(azimuth)) +
                              normal * cosine) *
                        (pi / (side * side));
        }
    }
    glm::dvec3 mean(0);
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c)
                mean[c] += double((*traced)[TracedLayer::irradiance].mean.at(x, y)[c]) / 256;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 0.005 * expected[c]) << c;
    EXPECT_LT((*traced)[TracedLayer::irradiance].relative_noise, 0.02);
    EXPECT_EQ((*traced)[TracedLayer::emission].mean.at(8, 8)[0], 0);
}

}  // namespace
}  // namespace lumo::reference
