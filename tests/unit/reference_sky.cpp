// The sun that lights scenes against the atmosphere's truth; and the path tracer under an environment map.
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "reference/atmosphere_optics.hpp"
#include "reference/environment.hpp"
#include "reference/path_tracer.hpp"
#include "reference/seen_sky.hpp"
#include "scene/builtin/geometry.hpp"
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

TEST(Daylight, IsTheSunsAndMostOfTheSkys) {
    const AtmosphereOptics optics(scene::earth());
    const auto weights = scene::rgb_weights(scene::earth().wavelengths_nm);
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    for (const double degrees : {0.0, 60.0, 85.0, 90.0, 92.0, 96.0}) {
        SCOPED_TRACE(degrees);
        const double zenith = glm::radians(degrees);
        const scene::Sky sky{.direction_to_sun = glm::vec3(std::sin(zenith), std::cos(zenith), 0)};
        const Estimate all = sky_irradiance(optics, {.sun_zenith_deg = degrees},
                                            {.first_order = 1, .last_order = all_orders, .samples = 4000});
        const double expected = glm::dot(scene::to_rgb(weights, all.mean), luminance);
        const scene::Daylight found = scene::daylight(sky);
        EXPECT_LT(found.sky, 1.1 * expected);
        EXPECT_GT(found.sky, 0.4 * expected);
        EXPECT_NEAR(found.sun, glm::dot(glm::dvec3(scene::sun_light(sky).intensity), luminance), 1e-9);
    }
    scene::Sky above{.direction_to_sun = {0, 1, 0}, .altitude_km = 400};
    EXPECT_NEAR(scene::daylight(above).sun * 683, 133e3, 4e3) << "lux";
    EXPECT_EQ(scene::daylight(above).sky, 0);
    above.direction_to_sun = {0, -1, 0};
    EXPECT_EQ(scene::daylight(above).sun, 0);
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

glm::vec3 sun_at(double zenith_deg) {
    const double zenith = glm::radians(zenith_deg);
    return glm::vec3(std::sin(zenith), std::cos(zenith), 0);
}

glm::dvec3 toward(double zenith_deg, double azimuth_deg) {
    const double zenith = glm::radians(zenith_deg), azimuth = glm::radians(azimuth_deg);
    return {std::sin(zenith) * std::cos(azimuth), std::cos(zenith), std::sin(zenith) * std::sin(azimuth)};
}

/// From places about the planet, where the vertical is another, against the integrals by angles.
TEST(SeenSky, IsTheAtmospheresLightInColours) {
    const scene::Sky sky{.direction_to_sun = sun_at(50)};
    const AtmosphereOptics optics(sky.atmosphere);
    const auto weights = scene::rgb_weights(sky.atmosphere.wavelengths_nm);
    const SeenSkyPaths paths{.count = 2000};
    for (const double altitude : {0.002, 5.0}) {
        for (const double turn : {0.0, 0.1}) {
            SCOPED_TRACE(fmt::format("{} km, {} radians on", altitude, turn));
            // As if the planet had been turned under the eye, about +z.
            const double r = 6360 + altitude;
            const glm::dvec3 eye(1000 * r * std::sin(turn), 1000 * (r * std::cos(turn) - 6360), 0);
            const SeenSky seen(sky, eye);
            const SkyView view{.altitude_km = altitude,
                               .view_zenith_deg = 80,
                               .sun_zenith_deg = 50 - glm::degrees(turn),
                               .azimuth_deg = 0,
                               .distance_km = 20};
            const glm::dvec3 direction = toward(80 + glm::degrees(turn), 0);
            const AirBefore air = seen.over(direction, 20e3, paths);
            scene::Spectrum light = radiance_order1(optics, view);
            const Estimate again = radiance(
                optics, view, {.first_order = 2, .last_order = all_orders, .samples = 5000, .seed = 7});
            for (size_t i = 0; i < light.size(); ++i) light[i] += again.mean[i];
            const glm::dvec3 expected = scene::to_rgb(weights, light);
            scene::Spectrum through = optics.transmittance_segment({altitude, cos_degrees(80)}, 20);
            glm::dvec3 sunlight(0);
            for (size_t i = 0; i < through.size(); ++i) {
                through[i] *= sky.atmosphere.sun_irradiance[i];
                sunlight += weights[i] * sky.atmosphere.sun_irradiance[i];
            }
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(air.radiance[c], expected[c], 0.02 * expected[c]);
                EXPECT_NEAR(air.transmittance[c], scene::to_rgb(weights, through)[c] / sunlight[c], 1e-6);
            }
        }
    }
}

/// White ground under a clear, conservative sky sends back what falls on it.
TEST(SeenSky, HasTheGroundBehindTheAir) {
    scene::Sky sky{.direction_to_sun = sun_at(40)};
    sky.atmosphere.mie.reset();
    sky.atmosphere.rayleigh.reset();
    sky.atmosphere.ozone.reset();
    sky.atmosphere.ground_albedo = {1, 1, 1};
    const auto weights = scene::rgb_weights(sky.atmosphere.wavelengths_nm);
    const glm::dvec3 expected =
        scene::to_rgb(weights, sky.atmosphere.sun_irradiance) * std::cos(glm::radians(40.0)) / pi;
    for (const double height : {0.0, 1.7, 10e3, 400e3}) {
        const glm::dvec3 down = SeenSky(sky, {0, height, 0}).beyond({0, -1, 0}, {.count = 1});
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(down[c], expected[c], 1e-6 * expected[c]) << height;
    }
    EXPECT_EQ(SeenSky(sky, {0, 2, 0}).beyond(toward(80, 30), {.count = 1}), glm::dvec3(0));
}

/// However large its pixels are, a picture of the sun has its irradiance.
TEST(PathTracerUnderASky, ShowsTheSunsDisc) {
    for (const uint32_t side : {24u, 3u, 1u}) {
        scene::Scene scene;
        set_sky(scene, {.direction_to_sun = sun_at(30)});
        const glm::dvec3 irradiance(scene.lights[0].intensity);
        constexpr double fov = 0.9 * pi / 180;
        const scene::Camera camera{.position = glm::vec3(0),
                                   .target = 10.0f * sun_at(30),
                                   .vertical_fov = float(fov),
                                   .near_plane = 0.1f,
                                   .far_plane = 100};
        PathTracerSettings settings{
            .width = side, .height = side, .spp = 2, .pixel_centers_only = true, .threads = 1};
        const auto with = path_trace(scene, camera, settings);
        ASSERT_TRUE(with);
        // The sky about the disc, by the same paths.
        scene.sky->atmosphere.sun_angular_radius_deg = 1e-9;
        const auto without = path_trace(scene, camera, settings);
        ASSERT_TRUE(without);
        glm::dvec3 sum(0);
        for (size_t i = 0; i < with->layers[0].mean.values.size(); ++i)
            sum[int(i % 3)] += double(with->layers[0].mean.values[i]) - without->layers[0].mean.values[i];
        const double pixel_angle = 2 * std::tan(0.5 * fov) / side;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] * pixel_angle * pixel_angle, irradiance[c], 0.02 * irradiance[c]) << side;
    }
}

/// A wall that glows, 20 km away, loses light to the air and gets the air's; its own layers do not.
TEST(PathTracerUnderASky, SeesSurfacesThroughTheAir) {
    scene::Scene scene;
    const glm::vec3 emission(30, 20, 10);
    const uint32_t glowing = scene::builtin::add_diffuse_material(scene, "glowing", glm::vec3(0));
    scene.materials[glowing].emission = emission;
    scene.materials[glowing].double_sided = true;
    scene::builtin::Model wall;
    append(wall[{glowing}], scene::builtin::parallelogram({20e3f, 200, -3000}, {0, 0, 6000}, {0, 3000, 0}));
    scene.instances.push_back({.mesh = add_mesh(scene, "wall", wall)});
    set_sky(scene, {.direction_to_sun = sun_at(50)});
    const scene::Camera camera{.position = {0, 1000, 0},
                               .target = {1000, 1000, 0},
                               .vertical_fov = 0.01f,
                               .near_plane = 0.1f,
                               .far_plane = 1e6f};
    const SeenSky sky(*scene.sky, glm::dvec3(camera.position));
    const AirBefore air = sky.over({1, 0, 0}, 20e3, {.count = 5000});
    const glm::dvec3 expected = glm::dvec3(emission) * air.transmittance + air.radiance;
    for (const bool centers : {true, false}) {
        const auto traced = path_trace(scene, camera,
                                       {.width = 2,
                                        .height = 2,
                                        .spp = 64,
                                        .pixel_centers_only = centers,
                                        .air_paths = 16,
                                        .layers = {TracedLayer::radiance, TracedLayer::emission}});
        ASSERT_TRUE(traced);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(double((*traced)[TracedLayer::radiance].mean.at(0, 0)[c]), expected[c],
                        0.02 * expected[c])
                << c;
            EXPECT_EQ((*traced)[TracedLayer::emission].mean.at(0, 0)[c], emission[c]);
        }
    }
}

}  // namespace
}  // namespace lumo::reference
