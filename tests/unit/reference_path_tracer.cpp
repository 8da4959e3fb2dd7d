// The path tracer where the answer is known.
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "reference/metrics.hpp"
#include "reference/path_tracer.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/geometry.hpp"

namespace lumo::reference {
namespace {

using scene::Scene;
using namespace scene::builtin;

constexpr double pi = std::numbers::pi;

const std::vector<TracedLayer> light_layers{TracedLayer::radiance, TracedLayer::direct,
                                            TracedLayer::indirect, TracedLayer::irradiance,
                                            TracedLayer::specular, TracedLayer::emission};

uint32_t place(Scene& scene, const Geometry& geometry, uint32_t material,
               const glm::mat4& placement = glm::mat4(1)) {
    Model model;
    append(model[Finish{material}], geometry);
    const uint32_t mesh = add_mesh(scene, "part", model);
    scene.instances.push_back({.mesh = mesh, .world_from_object = placement});
    return mesh;
}

uint32_t add_lamp(Scene& scene, glm::vec3 radiance, glm::vec3 albedo = glm::vec3(0)) {
    const uint32_t material = add_diffuse_material(scene, "lamp", albedo);
    scene.materials[material].emission = radiance;
    return material;
}

/// A square of that side about a point, seen from +Y.
Geometry floor_square(float side, glm::vec3 center = glm::vec3(0)) {
    return parallelogram(center + glm::vec3(-side / 2, 0, side / 2), {side, 0, 0}, {0, 0, -side});
}

/// Sees a spot 2 mm wide at the origin from a slant, so that no light straight above hides behind it.
scene::Camera spot_camera(glm::vec3 at = glm::vec3(0), glm::vec3 from = glm::vec3(1, 2, 3)) {
    return {.position = at + from, .target = at, .vertical_fov = 0.0005f};
}

PathTracerSettings tiny(uint32_t spp, std::optional<uint32_t> bounces = 0) {
    return {.width = 4,
            .height = 4,
            .spp = spp,
            .bounces = bounces,
            .diffuse_materials = true,
            .threads = 2,
            .layers = light_layers};
}

PathTraced traced(const Scene& scene, const scene::Camera& camera, const PathTracerSettings& settings) {
    auto result = path_trace(scene, camera, settings);
    EXPECT_TRUE(result) << to_string(result.error());
    return std::move(*result);
}

double mean_of(const PathTraced& result, TracedLayer layer) { return mean(result[layer].mean).value(); }

// -- analytic lights --------------------------------------------------------------------------------------

class SunOnPlane : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Degrees, SunOnPlane, ::testing::Values(0.0, 30.0, 60.0, 85.0, 95.0));

TEST_P(SunOnPlane, FollowsTheCosine) {
    const double angle = GetParam() * pi / 180;
    Scene scene;
    place(scene, floor_square(2), add_diffuse_material(scene, "grey", glm::vec3(0.25f, 0.5f, 1)));
    const glm::dvec3 to_sun(std::sin(angle), std::cos(angle), 0);
    scene.lights.push_back({.intensity = {4, 2, 1}, .direction = glm::vec3(-to_sun)});

    const PathTraced result = traced(scene, spot_camera(), tiny(2));
    const double expected = std::max(std::cos(angle), 0.0) / pi;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(result[TracedLayer::direct].mean.at(2, 1)[c], expected, 1e-6 * expected + 1e-9);
    EXPECT_EQ(mean_of(result, TracedLayer::irradiance), 0);
    EXPECT_EQ(mean_of(result, TracedLayer::emission), 0);
}

TEST(AnalyticLights, CastShadows) {
    Scene scene;
    const uint32_t grey = add_diffuse_material(scene, "grey", glm::vec3(0.5f));
    place(scene, floor_square(2), grey);
    place(scene, floor_square(0.5f, {0, 1, 0}), grey);
    scene.lights.push_back({.intensity = glm::vec3(1)});
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), 0);
    scene.lights[0] = {.kind = scene::LightKind::point, .intensity = glm::vec3(1), .position = {0, 2, 0}};
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), 0);
    scene.lights[0].position.y = 0.5f;  // below what shades
    EXPECT_NEAR(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), 0.5 / pi / 0.25, 1e-5);
}

TEST(AnalyticLights, PointAndSpotFallWithDistanceRangeAndCone) {
    Scene scene;
    place(scene, floor_square(20), add_diffuse_material(scene, "white", glm::vec3(1)));
    scene::Light& light = scene.lights.emplace_back();
    light = {.kind = scene::LightKind::point, .intensity = glm::vec3(8), .position = {3, 4, 0}};
    const auto direct = [&] { return mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct); };
    const double open = 8.0 / 25 * 0.8 / pi;
    EXPECT_NEAR(direct(), open, 1e-5 * open);
    light.range = 10;
    EXPECT_NEAR(direct(), open * (1 - 1.0 / 16), 1e-5 * open);
    light.range = 4.9f;
    EXPECT_EQ(direct(), 0);
    light.range = 0;

    light.kind = scene::LightKind::spot;
    light.direction = {-0.6f, -0.8f, 0};
    light.inner_cone_angle = 0.2f;
    light.outer_cone_angle = 0.4f;
    EXPECT_NEAR(direct(), open, 1e-5 * open);
    const double off_axis = 0.3;  // the axis turned away from the point by this
    const double axis = std::atan2(-0.8, -0.6) + off_axis;
    light.direction = glm::vec3(std::cos(axis), std::sin(axis), 0);
    const double part = (std::cos(off_axis) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
    EXPECT_NEAR(direct(), open * part * part, 1e-4 * open);
    light.direction = {0.6f, 0.8f, 0};
    EXPECT_EQ(direct(), 0);
}

TEST(AnalyticLights, ManyAddUp) {
    Scene scene;
    place(scene, floor_square(2), add_diffuse_material(scene, "white", glm::vec3(1)));
    double expected = 0;
    for (int i = 1; i <= 5; ++i) {
        scene.lights.push_back({.intensity = glm::vec3(float(i * i))});
        expected += i * i / pi;
    }
    EXPECT_NEAR(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), expected,
                1e-5 * expected);
    // Where some are shaded the choice among them makes noise.
    for (int i = 0; i < 5; ++i)
        scene.lights[size_t(i)].direction = glm::normalize(glm::vec3(0.5f * float(i) - 1, -1, 0));
    place(scene, floor_square(0.5f, {0, 1, 0}), 0);
    expected = 0;
    for (int i : {0, 1, 3, 4}) expected += (i + 1) * (i + 1) / pi / std::hypot(0.5 * i - 1, 1.0);
    const PathTraced result = traced(scene, spot_camera(glm::vec3(0), {0, 1, 4}), tiny(512));
    EXPECT_NEAR(mean_of(result, TracedLayer::direct), expected, 0.005 * expected);
}

// -- the furnace ------------------------------------------------------------------------------------------

TEST(Furnace, IsOneEverywhere) {
    const Scene scene = scene::make_builtin("furnace").value();
    for (const std::optional<uint32_t> bounces : {std::optional<uint32_t>(0), {2}, {}}) {
        PathTracerSettings settings = tiny(16, bounces);
        settings.width = settings.height = 16;
        const PathTraced result = traced(scene, scene.cameras[0], settings);
        for (const float value : result[TracedLayer::radiance].mean.values) ASSERT_NEAR(value, 1, 1e-5);
        EXPECT_NEAR(*std::ranges::max_element(result[TracedLayer::irradiance].mean.values), pi, 1e-4);
        EXPECT_NEAR(result[TracedLayer::irradiance].mean.at(8, 8)[1], pi, 1e-4);
        EXPECT_EQ(result[TracedLayer::irradiance].mean.at(0, 0)[1], 0);
        EXPECT_EQ(result[TracedLayer::emission].mean.at(0, 0)[1], 1);
        EXPECT_LT(result[TracedLayer::radiance].relative_noise, 1e-5);
    }
}

TEST(Furnace, OfASmoothSphereIsOneButForItsFacets) {
    Scene scene;
    place(scene, sphere(1, 64, 32), add_diffuse_material(scene, "white", glm::vec3(1)));
    scene.environment_radiance = glm::vec3(1);
    const PathTraced result = traced(scene, spot_camera({0, 0, 0.99f}, {0, 0, 3}), tiny(256));
    EXPECT_NEAR(mean_of(result, TracedLayer::radiance), 1, 0.005);
    EXPECT_NEAR(mean_of(result, TracedLayer::irradiance), pi, 0.005 * pi);
}

// -- form factors -----------------------------------------------------------------------------------------

// Mean irradiance of one unit square by another of radiance 1 is pi times the form factor.
TEST(FormFactor, OfParallelUnitSquares) {
    Scene scene;
    place(scene, floor_square(1), add_diffuse_material(scene, "white", glm::vec3(1)));
    const Geometry above = reversed(floor_square(1, {0, 1, 0}));
    place(scene, above, add_lamp(scene, glm::vec3(1)));
    // From between the two.
    const scene::Camera camera{.position = {0, 0.5f, 0}, .target = {0, 0, 0}, .orthographic_height = 1};
    PathTracerSettings settings = tiny(64);
    settings.width = settings.height = 32;
    const PathTraced result = traced(scene, camera, settings);
    // Two squares of side 1 at distance 1 (Howell, A Catalog of Radiation Heat Transfer, C-11).
    const double expected = 2 / pi *
                            (std::log(2 / std::sqrt(3.0)) +
                             2 * std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) - 2 * std::atan(1.0));
    EXPECT_NEAR(expected, 0.19982, 1e-5);
    EXPECT_NEAR(mean_of(result, TracedLayer::irradiance) / pi, expected, 0.005 * expected);
    EXPECT_NEAR(mean_of(result, TracedLayer::indirect), expected, 0.005 * expected);
    EXPECT_EQ(mean_of(result, TracedLayer::direct), 0);
}

TEST(FormFactor, OfPerpendicularUnitSquares) {
    Scene scene;
    place(scene, floor_square(1), add_diffuse_material(scene, "white", glm::vec3(1)));
    const Geometry wall = parallelogram({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 1, 0});
    place(scene, wall, add_lamp(scene, glm::vec3(1)));
    const scene::Camera camera{.position = {0, 0.5f, 0}, .target = {0, 0, 0}, .orthographic_height = 1};
    PathTracerSettings settings = tiny(64);
    settings.width = settings.height = 32;
    const PathTraced result = traced(scene, camera, settings);
    // Two squares of side 1 with a common edge (C-14 of the catalogue with h = w = 1).
    const double expected =
        (2 * std::atan(1.0) - std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) + 0.25 * std::log(0.75 * 1)) /
        pi;
    EXPECT_NEAR(expected, 0.20004, 1e-5);
    EXPECT_NEAR(mean_of(result, TracedLayer::irradiance) / pi, expected, 0.005 * expected);
}

// A wall under a sun that grazes the floor is a lamp for it, once light may be reflected before.
TEST(FormFactor, OfALitWall) {
    Scene scene;
    const uint32_t white = add_diffuse_material(scene, "white", glm::vec3(1));
    place(scene, floor_square(1), white);
    const uint32_t grey = add_diffuse_material(scene, "grey", glm::vec3(0.5f));
    place(scene, parallelogram({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 1, 0}), grey);
    scene.lights.push_back({.intensity = glm::vec3(2), .direction = {0, 0, -1}});
    const scene::Camera camera{.position = {0, 0.5f, 0}, .target = {0, 0, 0}, .orthographic_height = 1};
    PathTracerSettings settings = tiny(64);
    settings.width = settings.height = 32;
    EXPECT_EQ(mean_of(traced(scene, camera, settings), TracedLayer::irradiance), 0);
    settings.bounces = 1;
    EXPECT_NEAR(mean_of(traced(scene, camera, settings), TracedLayer::irradiance), 0.20004, 0.005 * 0.20004);
}

// -- many reflections -------------------------------------------------------------------------------------

class EnclosedSphere : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Bounces, EnclosedSphere, ::testing::Values(0, 1, 2, 5, -1));

// Within a sphere of uniform emission E and albedo a, radiance is E (1 + a + a² + …) everywhere.
TEST_P(EnclosedSphere, AddsTheGeometricSeries) {
    constexpr double albedo = 0.7;
    const std::optional<uint32_t> bounces =
        GetParam() < 0 ? std::nullopt : std::optional<uint32_t>(uint32_t(GetParam()));
    Scene scene;
    place(scene, reversed(faceted_sphere(2, 24, 12)), add_lamp(scene, glm::vec3(1, 2, 3), glm::vec3(albedo)));
    const scene::Camera camera{.position = {0.3f, 0.2f, 0.1f}, .target = {1, 0, 0}, .vertical_fov = 1};
    PathTracerSettings settings = tiny(512, bounces);
    settings.width = settings.height = 8;
    const PathTraced result = traced(scene, camera, settings);

    double expected = 1 / (1 - albedo);
    if (bounces) expected = (1 - std::pow(albedo, *bounces + 2)) / (1 - albedo);
    for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (uint32_t y = 0; y < 8; ++y)
            for (uint32_t x = 0; x < 8; ++x) sum += double(result[TracedLayer::radiance].mean.at(x, y)[c]);
        EXPECT_NEAR(sum / 64, (c + 1) * expected, 0.005 * (c + 1) * expected);
    }
    EXPECT_NEAR(mean_of(result, TracedLayer::indirect), 2 * (expected - 1), 0.01 * (expected - 1));
    EXPECT_NEAR(mean_of(result, TracedLayer::irradiance), 2 * pi * (expected - 1) / albedo,
                0.035 * (expected - 1));
    EXPECT_NEAR(mean_of(result, TracedLayer::emission), 2, 1e-6);
}

// -- its own noise ----------------------------------------------------------------------------------------

PathTracerSettings small_cornell(uint32_t seed) {
    PathTracerSettings settings = tiny(32, 2);
    settings.width = 32;
    settings.height = 32;
    settings.seed = seed;
    return settings;
}

TEST(Noise, IsWhatTwoSeedsDifferBy) {
    const Scene scene = scene::make_builtin("cornell").value();
    const PathTraced a = traced(scene, scene.cameras[0], small_cornell(1));
    const PathTraced b = traced(scene, scene.cameras[0], small_cornell(2));
    for (const TracedLayer layer : {TracedLayer::indirect, TracedLayer::irradiance}) {
        const double differ = relative_rmse(a[layer].mean, b[layer].mean).value();
        const double told = std::hypot(a[layer].relative_noise, b[layer].relative_noise);
        EXPECT_GT(told, 0);
        EXPECT_NEAR(differ / told, 1, 0.35) << to_string(layer);

        double squares = 0, told_squares = 0;
        for (size_t i = 0; i < a[layer].mean.values.size(); ++i) {
            squares += std::pow(double(a[layer].mean.values[i]) - double(b[layer].mean.values[i]), 2);
            told_squares +=
                std::pow(double(a[layer].noise.values[i]), 2) + std::pow(double(b[layer].noise.values[i]), 2);
        }
        EXPECT_NEAR(std::sqrt(squares / told_squares), 1, 0.25) << to_string(layer);
        EXPECT_NEAR(mean_of(a, layer) / mean_of(b, layer), 1, 3 * told);
    }
}

TEST(Noise, FallsWithSamplesAlsoOddOnes) {
    const Scene scene = scene::make_builtin("cornell").value();
    PathTracerSettings settings = small_cornell(1);
    settings.spp = 3;
    const double few = traced(scene, scene.cameras[0], settings)[TracedLayer::irradiance].relative_noise;
    settings.spp = 48;
    const double many = traced(scene, scene.cameras[0], settings)[TracedLayer::irradiance].relative_noise;
    EXPECT_LT(many, few / 3);
}

TEST(PathTracer, IsRepeatableForAnyNumberOfThreads) {
    const Scene scene = scene::make_builtin("cornell").value();
    PathTracerSettings settings = small_cornell(5);
    settings.spp = 4;
    settings.layers.push_back(TracedLayer::depth);
    settings.threads = 1;
    const PathTraced one = traced(scene, scene.cameras[0], settings);
    settings.threads = 3;
    const PathTraced three = traced(scene, scene.cameras[0], settings);
    settings.seed = 6;
    const PathTraced other = traced(scene, scene.cameras[0], settings);
    for (const TracedLayer layer : settings.layers)
        EXPECT_EQ(one[layer].mean.values, three[layer].mean.values);
    EXPECT_NE(one[TracedLayer::indirect].mean.values, other[TracedLayer::indirect].mean.values);
}

// -- layers -----------------------------------------------------------------------------------------------

TEST(Layers, AddUp) {
    Scene scene = scene::make_builtin("cornell").value();
    scene.lights.push_back(
        {.intensity = glm::vec3(3), .direction = glm::normalize(glm::vec3(0.2f, -0.3f, 1))});
    scene.environment_radiance = {0.2f, 0.3f, 0.4f};
    for (scene::Material& material : scene.materials) material.roughness = 0.4f;
    PathTracerSettings settings = small_cornell(1);
    settings.diffuse_materials = false;
    settings.spp = 8;
    const PathTraced result = traced(scene, scene.cameras[0], settings);
    double brightest_specular = 0;
    for (size_t i = 0; i < result[TracedLayer::radiance].mean.values.size(); ++i) {
        const auto value = [&](TracedLayer layer) { return double(result[layer].mean.values[i]); };
        const double sum = value(TracedLayer::direct) + value(TracedLayer::indirect) +
                           value(TracedLayer::specular) + value(TracedLayer::emission);
        ASSERT_NEAR(value(TracedLayer::radiance), sum, 1e-5 * sum);
        brightest_specular = std::max(brightest_specular, value(TracedLayer::specular));
    }
    EXPECT_GT(brightest_specular, 0);
}

TEST(Layers, OfALambertianSurfaceAreIrradianceTimesAlbedo) {
    const Scene scene = scene::make_builtin("cornell").value();
    PathTracerSettings settings = small_cornell(1);
    settings.spp = 4;
    settings.pixel_centers_only = true;
    settings.layers = {TracedLayer::indirect, TracedLayer::irradiance, TracedLayer::albedo,
                       TracedLayer::emission};
    const PathTraced result = traced(scene, scene.cameras[0], settings);
    for (size_t i = 0; i < result.layers[0].mean.values.size(); ++i) {
        const double expected = double(result[TracedLayer::irradiance].mean.values[i]) *
                                double(result[TracedLayer::albedo].mean.values[i]) / pi;
        ASSERT_NEAR(result[TracedLayer::indirect].mean.values[i], expected, 1e-5 * expected);
    }
}

TEST(Layers, OfTheSurfaceAreThoseAtThePixelsCentre) {
    Scene scene;
    place(scene, floor_square(4), add_diffuse_material(scene, "brown", {0.5f, 0.25f, 0.125f}));
    const scene::Camera camera{.position = {0, 3, 0}, .target = {0, 0, 0}, .vertical_fov = float(pi / 2)};
    PathTracerSettings settings = tiny(2);
    settings.layers = {TracedLayer::albedo, TracedLayer::normal, TracedLayer::depth};
    settings.width = 8;
    const PathTraced result = traced(scene, camera, settings);
    // The view is 12 m wide and 6 m high, so that the square's edges run 2 m from the centre.
    for (uint32_t y = 0; y < 4; ++y) {
        for (uint32_t x = 0; x < 8; ++x) {
            const bool inside = std::abs(1.5 * (x + 0.5) - 6) < 2 && std::abs(1.5 * (y + 0.5) - 3) < 2;
            EXPECT_NEAR(result[TracedLayer::depth].mean.at(x, y)[0], inside ? 3 : 0, 1e-5);
            EXPECT_NEAR(result[TracedLayer::normal].mean.at(x, y)[1], inside ? 1 : 0, 1e-6);
            EXPECT_NEAR(result[TracedLayer::albedo].mean.at(x, y)[1], inside ? 0.25 : 0, 1e-6);
        }
    }
}

// -- surfaces ---------------------------------------------------------------------------------------------

/// Between parallel planes at a distance h, a direction at the cosine c meets the other one at h / c: the integral of
/// 2 c / (1 + h / (r c)) over c is 1 - 2 q (1 - q log(1 + 1 / q)), q = h / r.
TEST(AmbientOcclusion, BetweenParallelPlanes) {
    for (const double distance : {0.25, 1.0, 4.0}) {
        Scene scene;
        const uint32_t white = add_diffuse_material(scene, "white", glm::vec3(0.5f));
        place(scene, floor_square(100), white);
        place(scene, floor_square(100, {0, float(distance), 0}), white);
        PathTracerSettings settings = tiny(4096);
        settings.layers = {TracedLayer::ao};
        settings.ao_radius = 2;
        const PathTraced result =
            traced(scene, spot_camera(glm::vec3(0), glm::vec3(0.1f, 0.2f, 0.1f)), settings);
        const double q = distance / 2;
        const double hidden = 1 - 2 * q * (1 - q * std::log(1 + 1 / q));
        EXPECT_NEAR(mean_of(result, TracedLayer::ao), 1 - hidden, 0.005 * (1 - hidden)) << distance;
    }
}

TEST(AmbientOcclusion, IsOneInTheOpenAndZeroWhereNothingIsDrawn) {
    Scene scene;
    place(scene, floor_square(1), add_diffuse_material(scene, "white", glm::vec3(0.5f)));
    PathTracerSettings settings = tiny(2);
    settings.layers = {TracedLayer::ao};
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), settings), TracedLayer::ao), 1);
    EXPECT_EQ(mean_of(traced(scene, spot_camera({5, 0, 5}), settings), TracedLayer::ao), 0);
}

TEST(Surfaces, OfOneSideAreSeenFromTheFrontAlone) {
    Scene scene;
    const uint32_t lamp = add_lamp(scene, glm::vec3(1));
    place(scene, floor_square(1), lamp);
    const scene::Camera below = spot_camera(glm::vec3(0), {0, -1, 0});
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::radiance), 1);
    EXPECT_EQ(mean_of(traced(scene, below, tiny(2)), TracedLayer::radiance), 0);
    scene.materials[lamp].double_sided = true;
    EXPECT_EQ(mean_of(traced(scene, below, tiny(2)), TracedLayer::radiance), 1);
    // A mirror keeps the front in front.
    scene.materials[lamp].double_sided = false;
    scene.instances[0].world_from_object[0][0] = -1;
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::radiance), 1);
    EXPECT_EQ(mean_of(traced(scene, below, tiny(2)), TracedLayer::radiance), 0);
}

TEST(Surfaces, OfMirroredLampsLightWhatTheyFace) {
    Scene scene;
    place(scene, floor_square(20), add_diffuse_material(scene, "white", glm::vec3(1)));
    place(scene, reversed(floor_square(2, {0, 2, 0})), add_lamp(scene, glm::vec3(1)));
    const double plain =
        mean_of(traced(scene, spot_camera(glm::vec3(0), {6, 1, 0}), tiny(256)), TracedLayer::irradiance);
    scene.instances[1].world_from_object[0][0] = -1;
    const double mirrored =
        mean_of(traced(scene, spot_camera(glm::vec3(0), {6, 1, 0}), tiny(256)), TracedLayer::irradiance);
    EXPECT_GT(plain, 0);
    EXPECT_NEAR(mirrored / plain, 1, 0.01);
}

TEST(Surfaces, OfOneSideEmitAtTheirFrontAlone) {
    Scene scene;
    place(scene, floor_square(1), add_diffuse_material(scene, "white", glm::vec3(1)));
    const uint32_t lamp = add_lamp(scene, glm::vec3(1));
    place(scene, floor_square(1, {0, 1, 0}), lamp);
    const scene::Camera camera = spot_camera(glm::vec3(0), {2, 1, 0});
    EXPECT_EQ(mean_of(traced(scene, camera, tiny(64)), TracedLayer::irradiance), 0);
    scene.materials[lamp].double_sided = true;
    EXPECT_NEAR(mean_of(traced(scene, camera, tiny(256)), TracedLayer::irradiance), 0.2395 * pi, 0.01);
}

TEST(Surfaces, GetNoLightFromBehindTheirTriangles) {
    Scene scene;
    Geometry leaning = floor_square(1);
    for (scene::Vertex& vertex : leaning.vertices) vertex.normal = glm::normalize(glm::vec3(1, 1, 0));
    place(scene, leaning, add_diffuse_material(scene, "white", glm::vec3(1)));
    scene.lights.push_back({.intensity = glm::vec3(1), .direction = glm::normalize(glm::vec3(-1, 0.1f, 0))});
    EXPECT_EQ(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), 0);
    scene.lights[0].direction = {0, -1, 0};
    EXPECT_NEAR(mean_of(traced(scene, spot_camera(), tiny(2)), TracedLayer::direct), std::sqrt(0.5) / pi,
                1e-6);
    // Of the hemisphere about a normal at 45 degrees, the part behind the plane is black.
    scene.lights.clear();
    scene.environment_radiance = glm::vec3(1);
    EXPECT_NEAR(mean_of(traced(scene, spot_camera(), tiny(256)), TracedLayer::irradiance),
                pi * (1 + std::sqrt(0.5)) / 2, 0.01);
}

TEST(Surfaces, LeanAsTheirNormalMapsSay) {
    Scene scene;
    const uint32_t mapped = add_diffuse_material(scene, "mapped", glm::vec3(1));
    // (0.6, 0.2, 0.8) before its length is taken away.
    scene.images.push_back({.width = 1, .height = 1, .values = {204, 153, 230, 255}});
    scene.textures.push_back({.image = 0, .sampler = {}});
    scene.materials[mapped].normal_texture = scene::TextureSlot{};
    scene.materials[mapped].normal_scale = 0.5f;
    place(scene, floor_square(1), mapped);
    PathTracerSettings settings = tiny(2);
    settings.layers = {TracedLayer::normal};
    settings.diffuse_materials = false;
    const auto normal = [&] {
        const PathTraced result = traced(scene, spot_camera(), settings);
        const float* values = result.layers[0].mean.at(1, 1);
        return glm::dvec3(values[0], values[1], values[2]);
    };
    // u runs along +X and v, whose opposite is the bitangent, along +Z.
    const glm::dvec3 expected = glm::normalize(glm::dvec3(0.5 * 0.6, 230 / 127.5 - 1, -0.5 * 0.2));
    EXPECT_LT(glm::length(normal() - expected), 1e-5);
    settings.diffuse_materials = true;
    EXPECT_EQ(normal(), glm::dvec3(0, 1, 0));
    // A mirror in x turns the tangent, and not the bitangent.
    settings.diffuse_materials = false;
    scene.instances[0].world_from_object[0][0] = -1;
    EXPECT_LT(glm::length(normal() - expected * glm::dvec3(-1, 1, 1)), 1e-5);
}

TEST(Surfaces, TakeMetalAndRoughnessFromTextures) {
    Scene scene;
    const uint32_t mapped = add_diffuse_material(scene, "mapped", glm::vec3(1));
    scene.images.push_back({.width = 1, .height = 1, .values = {0, 51, 255, 255}});
    scene.textures.push_back({.image = 0, .sampler = {}});
    scene.materials[mapped].metallic = scene.materials[mapped].roughness = 1;
    scene.materials[mapped].metallic_roughness_texture = scene::TextureSlot{};
    place(scene, floor_square(1), mapped);
    PathTracerSettings settings = tiny(2);
    settings.diffuse_materials = false;
    // At the mirror direction GGX is 1 / (pi alpha²), and the visibility with n·l = n·v = 0.5 closed too.
    const glm::vec3 to_eye = glm::normalize(glm::vec3(std::sqrt(3.0f), 1, 0));
    scene.lights.push_back({.intensity = glm::vec3(1), .direction = {to_eye.x, -to_eye.y, 0}});
    const double roughness = 0.2, k = 1.2 * 1.2 / 8;
    const double expected = 1 / (pi * std::pow(roughness, 4)) * 0.25 / std::pow(0.5 * (1 - k) + k, 2) * 0.5;
    const scene::Camera camera = spot_camera(glm::vec3(0), 3.0f * to_eye);
    const PathTraced result = traced(scene, camera, settings);
    EXPECT_NEAR(mean_of(result, TracedLayer::direct), expected, 1e-3 * expected);
    settings.diffuse_materials = true;
    EXPECT_NEAR(mean_of(traced(scene, camera, settings), TracedLayer::direct), 0.5 / pi, 1e-5);
}

/// A floor under the sun with a sheet above it whose texture's left half has that alpha, the right half 255.
Scene sheet_over_floor(scene::AlphaMode mode, uint8_t alpha) {
    Scene scene;
    place(scene, floor_square(4), add_diffuse_material(scene, "white", glm::vec3(1)));
    const uint32_t sheet = add_diffuse_material(scene, "sheet", glm::vec3(0));
    scene.images.push_back({.width = 2, .height = 1, .values = {0, 0, 0, alpha, 0, 0, 0, 255}});
    scene.textures.push_back({.image = 0, .sampler = {.magnification = scene::Filter::nearest}});
    scene.materials[sheet].base_color = {1, 1, 1, 1};
    scene.materials[sheet].base_color_texture = scene::TextureSlot{};
    scene.materials[sheet].alpha_mode = mode;
    Geometry square = floor_square(1, {0, 1, 0});
    for (scene::Vertex& vertex : square.vertices) vertex.uv0 = {vertex.position.x + 0.5f, 0.5f};
    place(scene, square, sheet);
    scene.lights.push_back({.intensity = glm::vec3(float(pi))});
    return scene;
}

double lit_at(const Scene& scene, float x) {
    return mean_of(traced(scene, spot_camera({x, 0, 0}, {0, 1, 4}), tiny(256)), TracedLayer::direct);
}

TEST(Surfaces, OfMaskLetLightThroughTheirHoles) {
    const Scene scene = sheet_over_floor(scene::AlphaMode::mask, 100);
    EXPECT_NEAR(lit_at(scene, -0.25f), 1, 1e-5);
    EXPECT_EQ(lit_at(scene, 0.25f), 0);
    const scene::Camera above = spot_camera({-0.25f, 1, 0}, {0.001f, 2, 0});
    EXPECT_NEAR(mean_of(traced(scene, above, tiny(2)), TracedLayer::direct), 1, 1e-5);
}

TEST(Surfaces, OfBlendTakeTheirShare) {
    const Scene scene = sheet_over_floor(scene::AlphaMode::blend, 102);
    EXPECT_NEAR(lit_at(scene, -0.25f), 0.6, 0.02);
    EXPECT_EQ(lit_at(scene, 0.25f), 0);
    // The sheet is black: seen through it, and lit through it.
    const scene::Camera above = spot_camera({-0.25f, 1, 0}, {0.001f, 2, 0});
    EXPECT_NEAR(mean_of(traced(scene, above, tiny(1024)), TracedLayer::direct), 0.36, 0.02);
}

TEST(Surfaces, TakeTheirColourFromTexturesInLinearLight) {
    Scene scene;
    const uint32_t textured = add_diffuse_material(scene, "textured", glm::vec3(1));
    scene.images.push_back({.width = 2, .height = 1, .values = {0, 0, 0, 255, 188, 188, 188, 255}});
    scene.textures.push_back({.image = 0, .sampler = {.wrap_u = scene::Wrap::clamp_to_edge}});
    scene.materials[textured].base_color_texture = scene::TextureSlot{};
    Geometry square = floor_square(1);
    for (scene::Vertex& vertex : square.vertices) vertex.uv0 = {vertex.position.x + 0.5f, 0.5f};
    place(scene, square, textured);
    PathTracerSettings settings = tiny(2);
    settings.layers = {TracedLayer::albedo};
    const double texel = std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
    // uv 0.25 and 0.75 are the texels' centres.
    for (const auto& [x, expected] :
         {std::pair(-0.4f, 0.0), {-0.25f, 0.0}, {0.0f, texel / 2}, {0.125f, 0.75 * texel}, {0.4f, texel}}) {
        const PathTraced result = traced(scene, spot_camera({x, 0, 0}), settings);
        EXPECT_NEAR(mean_of(result, TracedLayer::albedo), expected, 1e-3) << x;
    }
}

TEST(Surfaces, OfMetalReflectTheEnvironmentByTheirSpecularLobe) {
    Scene scene;
    const uint32_t metal = add_diffuse_material(scene, "metal", glm::vec3(1));
    scene.materials[metal].metallic = 1;
    scene.materials[metal].roughness = 0.1f;
    place(scene, floor_square(1), metal);
    scene.environment_radiance = glm::vec3(1);
    PathTracerSettings settings = tiny(256);
    settings.diffuse_materials = false;
    const PathTraced result = traced(scene, spot_camera(), settings);
    EXPECT_EQ(mean_of(result, TracedLayer::indirect), 0);
    // k of the analytic lights' fit takes a few percent from smooth metals, and never adds.
    EXPECT_GT(mean_of(result, TracedLayer::specular), 0.7);
    EXPECT_LT(mean_of(result, TracedLayer::specular), 1.001);
    EXPECT_NEAR(mean_of(result, TracedLayer::irradiance), pi, 0.02 * pi);
}

TEST(Surfaces, ThatAreUnlitShowTheirColour) {
    Scene scene;
    const uint32_t sign = add_diffuse_material(scene, "sign", {0.25f, 0.5f, 0.75f});
    scene.materials[sign].unlit = true;
    place(scene, floor_square(1), sign);
    scene.environment_radiance = glm::vec3(1);
    const PathTraced result = traced(scene, spot_camera(), tiny(2));
    EXPECT_EQ(mean_of(result, TracedLayer::radiance), 0.5);
    EXPECT_EQ(mean_of(result, TracedLayer::irradiance), 0);
}

// -- the whole --------------------------------------------------------------------------------------------

TEST(PathTracer, TellsProgressToTheEnd) {
    const Scene scene = scene::make_builtin("cornell").value();
    PathTracerSettings settings = tiny(2);
    settings.width = settings.height = 40;
    std::vector<double> told;
    ASSERT_TRUE(path_trace(scene, scene.cameras[0], settings, [&](double part) { told.push_back(part); }));
    EXPECT_EQ(told.size(), 9u);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back(), 1);
}

TEST(PathTracer, RefusesWhatHasNoMeaning) {
    const Scene scene;
    PathTracerSettings settings = tiny(1);
    EXPECT_EQ(path_trace(scene, {}, settings).error().kind, ErrorKind::invalid_argument);
    settings = tiny(2);
    settings.height = 0;
    EXPECT_EQ(path_trace(scene, {}, settings).error().kind, ErrorKind::invalid_argument);
}

TEST(PathTracer, SeesTheEnvironmentOfAnEmptyScene) {
    Scene scene;
    scene.environment_radiance = glm::vec3(2);
    EXPECT_EQ(mean_of(traced(scene, {}, tiny(2)), TracedLayer::radiance), 2);
}

}  // namespace
}  // namespace lumo::reference
