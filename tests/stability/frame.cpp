// Extreme scenes through whole frames: every value of every layer is a finite number, none is negative that must not
// be, and nothing is brighter than its light.
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using frame::Layer;
using scene::builtin::box;
using scene::builtin::parallelogram;

const std::vector<Layer> all_layers{Layer::radiance, Layer::direct, Layer::indirect, Layer::irradiance,
                                    Layer::emission, Layer::albedo, Layer::normal,   Layer::depth,
                                    Layer::voxels,   Layer::ao,     Layer::specular, Layer::final};

struct FrameStabilityTest : DeviceTest {
    frame::Rendered render(const scene::Scene& scene, frame::Settings settings = {}) {
        return render(scene, scene::default_camera(scene), settings);
    }
    frame::Rendered render(const scene::Scene& scene, const scene::Camera& camera,
                           frame::Settings settings = {}) {
        settings.size = {24, 16};
        settings.layers = all_layers;
        settings.voxels.resolution = 16;
        settings.shadow.resolution = 128;
        frame::Rendered rendered = must(frame::render(device(), scene, camera, settings));
        for (const frame::LayerImage& layer : rendered.layers) {
            size_t not_finite = 0, negative = 0;
            for (const float value : layer.linear.values) {
                not_finite += !std::isfinite(value);
                negative += value < 0;
            }
            EXPECT_EQ(not_finite, 0u) << to_string(layer.layer);
            if (layer.layer != Layer::normal) {
                EXPECT_EQ(negative, 0u) << to_string(layer.layer);
            }
        }
        return rendered;
    }
};
INSTANTIATE_TEST_SUITE_P(Stability, FrameStabilityTest, both_apis, api_name);

const scene::ImageF& layer_of(const frame::Rendered& rendered, Layer wanted) {
    for (const frame::LayerImage& layer : rendered.layers)
        if (layer.layer == wanted) return layer.linear;
    throw std::runtime_error("layer not rendered");
}

float highest(const scene::ImageF& image) {
    return *std::max_element(image.values.begin(), image.values.end());
}
double sum(const scene::ImageF& image) {
    double total = 0;
    for (const float v : image.values) total += double(v);
    return total;
}

void add_sun(scene::Scene& scene, glm::vec3 irradiance, glm::vec3 to_sun = {0.4f, 1, 0.3f}) {
    scene.lights.push_back({.kind = scene::LightKind::directional,
                            .intensity = irradiance,
                            .direction = -glm::normalize(to_sun)});
}

/// A floor, a box on it and a lamp, under a sun and a sky.
scene::Scene small_scene(float scale = 1) {
    scene::Scene scene;
    add(scene, parallelogram(scale * glm::vec3(-1, 0, 1), {2 * scale, 0, 0}, {0, 0, -2 * scale}),
        diffuse({0.7f, 0.6f, 0.5f}));
    add(scene, box(scale * glm::vec3(-0.3f, 0, -0.3f), scale * glm::vec3(0.3f, 0.6f, 0.3f)),
        diffuse({0.2f, 0.5f, 0.8f}));
    add(scene, box(scale * glm::vec3(0.5f, 0.4f, 0.1f), scale * glm::vec3(0.7f, 0.6f, 0.3f)),
        diffuse(glm::vec3(0.1f), {3, 2, 1}));
    scene.environment_radiance = glm::vec3(0.5f);
    add_sun(scene, {3, 2.5f, 2});
    return scene;
}

TEST_P(FrameStabilityTest, EmptyScene) {
    scene::Scene scene;
    const frame::Rendered nothing = render(scene);
    EXPECT_EQ(highest(layer_of(nothing, Layer::radiance)), 0);
    scene.environment_radiance = {1, 2, 3};
    add_sun(scene, glm::vec3(5));
    for (const frame::PlanMode plan : {frame::PlanMode::automatic, frame::PlanMode::full}) {
        const frame::Rendered sky = render(scene, {.bounces = 2, .plan = plan});
        const scene::ImageF& radiance = layer_of(sky, Layer::radiance);
        for (size_t i = 0; i < radiance.values.size(); ++i) ASSERT_EQ(radiance.values[i], float(i % 3 + 1));
        EXPECT_EQ(highest(layer_of(sky, Layer::irradiance)), 0);
    }
}

TEST_P(FrameStabilityTest, TrianglesWithoutArea) {
    const glm::vec3 a(0.1f, 0.2f, 0.3f), b(0.7f, 0.2f, 0.5f);
    for (const auto& shape : {triangle(a, a, a), triangle(a, b, a), triangle(a, b, 0.5f * (a + b)),
                              triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0})}) {
        scene::Scene scene;
        add(scene, shape, diffuse(glm::vec3(0.5f), glm::vec3(1)));
        add_sun(scene, glm::vec3(5));
        scene.environment_radiance = glm::vec3(1);
        render(scene, {.bounces = 2});
    }
}

TEST_P(FrameStabilityTest, NeedlesAmongOtherThings) {
    scene::Scene scene = small_scene();
    for (const float width : {1e-3f, 1e-6f, 1e-12f, 1e-30f, 0.0f})
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 along(0), across(0);
            along[axis] = 1;
            across[(axis + 1) % 3] = width;
            add(scene,
                triangle({-0.5f, 0.3f, 0}, glm::vec3(-0.5f, 0.3f, 0) + along + across,
                         glm::vec3(-0.5f, 0.3f, 0) + along - across),
                diffuse(glm::vec3(0.5f)));
        }
    render(scene, {.bounces = 2});
}

TEST_P(FrameStabilityTest, ScenesOfEverySize) {
    const double reference = sum(layer_of(render(small_scene(), {.bounces = 2}), Layer::radiance));
    for (const float scale : {1e-3f, 1e2f, 1e5f}) {
        SCOPED_TRACE(fmt::format("{} m", scale));
        const double here = sum(layer_of(render(small_scene(scale), {.bounces = 2}), Layer::radiance));
        EXPECT_NEAR(here, reference, 0.03 * reference);
    }
}

TEST_P(FrameStabilityTest, ScenesOfOneWideSide) {
    for (const glm::vec3 size : {glm::vec3(1e5f, 1e-3f, 1e-3f), glm::vec3(1e-3f, 1e5f, 1e-3f),
                                 glm::vec3(1e5f, 1, 1e5f), glm::vec3(1e-3f, 1e-3f, 1e-3f)}) {
        SCOPED_TRACE(fmt::format("{} {} {}", size.x, size.y, size.z));
        scene::Scene scene;
        add(scene, box(-0.5f * size, 0.5f * size), diffuse(glm::vec3(0.5f)));
        add_sun(scene, glm::vec3(5));
        scene.environment_radiance = glm::vec3(1);
        render(scene, {.bounces = 2});
    }
}

TEST_P(FrameStabilityTest, FarFromTheOrigin) {
    const double reference = sum(layer_of(render(small_scene(), {.bounces = 2}), Layer::radiance));
    scene::Scene scene = small_scene();
    for (scene::Instance& instance : scene.instances)
        instance.world_from_object = scene::builtin::translation({4000, -2000, 1000});
    const double far = sum(layer_of(render(scene, {.bounces = 2}), Layer::radiance));
    EXPECT_NEAR(far, reference, 0.05 * reference);
}

/// What is twice as bright is seen as twice as bright, whatever the unit.
TEST_P(FrameStabilityTest, RadianceOfEveryMagnitude) {
    const auto scaled = [](float factor) {
        scene::Scene scene = small_scene();
        scene.environment_radiance *= factor;
        for (scene::Light& light : scene.lights) light.intensity *= factor;
        for (scene::Material& material : scene.materials) material.emission *= factor;
        return scene;
    };
    const double reference = sum(layer_of(render(scaled(1), {.bounces = 2}), Layer::indirect));
    ASSERT_GT(reference, 1);
    for (const float factor : {1e-6f, 1e3f, 1e6f}) {
        SCOPED_TRACE(fmt::format("times {}", factor));
        const double here = sum(layer_of(render(scaled(factor), {.bounces = 2}), Layer::indirect));
        EXPECT_NEAR(here / double(factor), reference, 2e-3 * reference);
    }
}

/// A million times brighter lamp beside a weak one.
TEST_P(FrameStabilityTest, LightsOfDifferentMagnitudes) {
    for (const auto& [emission, environment, sun] :
         {std::tuple(1e6f, 1e-6f, 1.0f), std::tuple(1e-6f, 1e6f, 1.0f), std::tuple(1.0f, 1.0f, 1e6f)}) {
        SCOPED_TRACE(fmt::format("emission {}, environment {}, sun {}", emission, environment, sun));
        scene::Scene scene = small_scene();
        scene.environment_radiance = glm::vec3(environment);
        scene.lights[0].intensity = glm::vec3(sun);
        scene.materials[2].emission = glm::vec3(emission);
        const frame::Rendered rendered = render(scene, {.bounces = 3});
        const float brightest = emission + environment + sun;
        EXPECT_LE(highest(layer_of(rendered, Layer::indirect)), 1.1f * brightest);
        EXPECT_GT(highest(layer_of(rendered, Layer::irradiance)), 0);
    }
}

TEST_P(FrameStabilityTest, ThousandsOfTrianglesInOneVoxel) {
    scene::Scene scene = small_scene();
    scene::builtin::Geometry crowd;
    for (int i = 0; i < 10000; ++i) {
        const float offset = 1e-6f * float(i);
        scene::builtin::append(
            crowd, parallelogram(glm::vec3(-0.6f, 0.5f + offset, -0.6f), {0.1f, 0, 0}, {0, 0, -0.1f}));
    }
    add(scene, crowd, diffuse({1, 1, 1}));
    render(scene, {.bounces = 2});
}

TEST_P(FrameStabilityTest, SurfacesOnTheFacesOfVoxels) {
    // 16 voxels over 15 units: faces lie at half units from the corner.
    scene::Scene scene;
    add(scene, box({0, 0, 0}, {15, 15, 15}), diffuse(glm::vec3(0.5f)));
    for (int i = 1; i < 14; i += 3)
        add(scene, box(glm::vec3(float(i) + 0.5f), glm::vec3(float(i) + 1.5f)), diffuse({0.8f, 0.2f, 0.2f}));
    add_sun(scene, glm::vec3(5), {0, 1, 0});
    scene.environment_radiance = glm::vec3(1);
    render(scene, {.bounces = 2});
}

TEST_P(FrameStabilityTest, CamerasInAndOutOfTheGrid) {
    const scene::Scene scene = small_scene();
    const glm::vec3 target(0, 0.3f, 0);
    for (const glm::vec3 position : {glm::vec3(0.1f, 0.3f, 0.05f), glm::vec3(0.9f, 0.9f, 0.9f),
                                     glm::vec3(0, 0.01f, 0.8f), glm::vec3(300, 200, 100), glm::vec3(0, 5, 0),
                                     glm::vec3(0, -5, 0), glm::vec3(-5, 0, 0), glm::vec3(0, 0.3f, 1e-3f)}) {
        SCOPED_TRACE(fmt::format("camera at {} {} {}", position.x, position.y, position.z));
        render(scene, {.position = position, .target = target, .vertical_fov = 1, .near_plane = 1e-3f},
               {.bounces = 2});
    }
    scene::Camera flat{.position = {0, 5, 0}, .target = {0, 0, 0}, .orthographic_height = 3.0f};
    const frame::Rendered above = render(scene, flat);
    EXPECT_GT(highest(layer_of(above, Layer::depth)), 4);
}

TEST_P(FrameStabilityTest, SunsAlongAxesAndBelowTheFloor) {
    for (const glm::vec3 to_sun :
         {glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
          glm::vec3(1, 0.01f, 0), glm::vec3(0.577f, 0.577f, 0.577f)}) {
        SCOPED_TRACE(fmt::format("sun at {} {} {}", to_sun.x, to_sun.y, to_sun.z));
        scene::Scene scene = small_scene();
        scene.lights.clear();
        add_sun(scene, glm::vec3(4), to_sun);
        render(scene, {.bounces = 2});
    }
}

TEST_P(FrameStabilityTest, EveryCountOfConesAndBounces) {
    const scene::Scene scene = small_scene();
    for (const auto& [cones, bounces] : {std::pair(1, 1u), std::pair(2, 8u), std::pair(32, 1u)}) {
        frame::Settings settings{.bounces = bounces};
        settings.cones.count = cones;
        const frame::Rendered rendered = render(scene, settings);
        EXPECT_GT(highest(layer_of(rendered, Layer::irradiance)), 0.1f);
    }
}

/// Physics leaves both walls black: the red one sees blue light alone, as does the green one.
TEST_P(FrameStabilityTest, ColoursDoNotLeakBetweenChannels) {
    const scene::Scene scene = value_of(scene::make_builtin("area-light-pure"));
    // Lambertian: the specular lobe of any surface but a metal is white.
    const frame::Rendered rendered = render(scene, {.diffuse_materials = true, .bounces = 3});
    const scene::ImageF &radiance = layer_of(rendered, Layer::radiance),
                        &albedo = layer_of(rendered, Layer::albedo);
    int walls = 0;
    for (uint32_t y = 0; y < radiance.height; ++y)
        for (uint32_t x = 0; x < radiance.width; ++x) {
            EXPECT_EQ(radiance.at(x, y)[0], 0);
            EXPECT_EQ(radiance.at(x, y)[1], 0);
            const bool wall = albedo.at(x, y)[2] == 0 && albedo.at(x, y)[0] + albedo.at(x, y)[1] > 0.5f;
            if (!wall) continue;
            ++walls;
            EXPECT_EQ(radiance.at(x, y)[2], 0);
        }
    EXPECT_GT(walls, 20);
    EXPECT_GT(highest(radiance), 9) << "the lamp is seen";
}

TEST_P(FrameStabilityTest, SurfacesOfEveryRoughness) {
    for (const float roughness : {0.0f, 0.2f, 1.0f})
        for (const float metallic : {0.0f, 1.0f}) {
            SCOPED_TRACE(fmt::format("roughness {}, metallic {}", roughness, metallic));
            scene::Scene scene = small_scene();
            for (scene::Material& material : scene.materials) {
                material.roughness = roughness;
                material.metallic = metallic;
            }
            const frame::Rendered rendered = render(scene);
            // No surface reflects more than the lamp, which is the brightest there is, sends.
            EXPECT_GT(highest(layer_of(rendered, Layer::specular)), 0);
            EXPECT_LT(highest(layer_of(rendered, Layer::specular)), 3.1f);
        }
}

}  // namespace
}  // namespace lumo
