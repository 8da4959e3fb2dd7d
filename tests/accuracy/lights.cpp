// Point, spot and several lights, and their shadows, against KHR_lights_punctual's formulas in double precision.
#include "reference/lights.hpp"

#include <functional>
#include <gtest/gtest.h>

#include "techniques/lighting/lighting.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::lighting {
namespace {

using namespace testing_support;

constexpr rhi::Extent size{64, 48};

struct LightsTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, LightsTest, both_apis, api_name);

scene::Camera looking(glm::vec3 position, glm::vec3 target, glm::vec3 up = {0, 1, 0}) {
    scene::Camera camera;
    camera.position = position;
    camera.target = target;
    camera.up = up;
    camera.vertical_fov = glm::radians(60.0f);
    camera.near_plane = 0.1f;
    camera.far_plane = 100;
    return camera;
}

/// What an unshadowed white surface reflects at a pixel, W/m²/sr.
glm::dvec3 expected_radiance(std::span<const scene::Light> lights, glm::dvec3 position, glm::dvec3 normal) {
    glm::dvec3 sum(0);
    for (const scene::Light& light : lights)
        if (const auto incident = reference::incident(light, position))
            sum += incident->irradiance * std::max(glm::dot(normal, incident->to_light), 0.0) / M_PI;
    return sum;
}

/// Every pixel of a scene of unshadowed surfaces, as its G-buffer has position and normal, but for positions that are
/// left out. Returns how many were lit.
int expect_unshadowed(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera,
                      std::span<const scene::Light> lights, double tolerance,
                      const std::function<bool(glm::dvec3)>& left_out = {}) {
    const RenderedTargets targets =
        render(device, scene, camera,
               {.size = size, .lights = {lights.begin(), lights.end()}, .diffuse_materials = true});
    const glm::dvec3 axis = glm::normalize(glm::dvec3(camera.target) - glm::dvec3(camera.position));
    int lit = 0;
    double brightest = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x)
            brightest = std::max(brightest, double(targets.direct.at(x, y).x));
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            const double depth = double(targets.depth.at(x, y).x);
            if (depth == 1) continue;
            const double near = double(camera.near_plane), far = double(camera.far_plane);
            const Ray ray = pixel_ray(camera, size, x, y);
            const double distance = near * far / (far - depth * (far - near)) / glm::dot(ray.direction, axis);
            const glm::dvec3 position = ray.origin + ray.direction * distance;
            if (left_out && left_out(position)) continue;
            const glm::dvec3 expected = expected_radiance(
                lights, position, glm::normalize(glm::dvec3(targets.normal_roughness.at(x, y))));
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(targets.direct.at(x, y)[c], expected[c],
                            tolerance * std::max(expected[c], 0.01 * brightest))
                    << x << ", " << y;
            lit += expected.x > 0;
        }
    return lit;
}

void add_room(scene::Scene& scene, float half) {
    const glm::vec3 x{half, 0, 0}, y{0, half, 0}, z{0, 0, half};
    add_quad(scene, -y, x, -z, {});
    add_quad(scene, y, x, z, {});
    add_quad(scene, -x, z, -y, {});
    add_quad(scene, x, z, y, {});
    add_quad(scene, -z, x, y, {});
    add_quad(scene, z, x, -y, {});
    for (size_t i = 0; i < scene.vertices.size(); ++i)
        ASSERT_LT(glm::length(scene.vertices[i].normal), 1.001f);
}

/// All walls of a room, seen from a corner, across the seams of the light's six maps: no acne, no dark seam.
TEST_P(LightsTest, PointLightReachesEveryWallOfARoom) {
    scene::Scene scene;
    add_room(scene, 2);
    // Within the filter's reach of a corner one wall shades the other: 1.5 texels of the map, 3 mm here.
    const auto in_a_corner = [](glm::dvec3 p) {
        const glm::dvec3 size = glm::abs(p);
        const double second = std::max(std::min(size.x, size.y), std::min(std::max(size.x, size.y), size.z));
        return second > 2 - 0.006;
    };
    for (const glm::vec3 position :
         {glm::vec3(0), glm::vec3(0.7f, -0.4f, 1.1f), glm::vec3(-1.8f, 1.8f, -1.8f)}) {
        const std::array lights{
            scene::Light{.kind = scene::LightKind::point, .intensity = {4, 2, 1}, .position = position}};
        for (const float side : {1.0f, -1.0f})
            EXPECT_GT(expect_unshadowed(device(), scene,
                                        looking(glm::vec3(side) * glm::vec3(1.9f, 1.8f, 1.9f), glm::vec3(0)),
                                        lights, 2e-3, in_a_corner),
                      int(size.width * size.height / 2));
    }
}

/// Falls off with range and cone as the extension says; narrow, wide (six maps) and with a sharp edge.
TEST_P(LightsTest, SpotLightFallsOffWithConeAndRange) {
    scene::Scene scene;
    add_quad(scene, {0, 0, 0}, {6, 0, 0}, {0, 0, -6}, {});
    const scene::Camera camera = looking({0, 7, 0}, {0, 0, 0}, {0, 0, -1});
    scene::Light light{.kind = scene::LightKind::spot,
                       .intensity = {9, 6, 3},
                       .position = {0.5f, 3, 0.2f},
                       .direction = glm::normalize(glm::vec3(0.2f, -1, 0.1f))};
    for (const auto& [inner, outer] : {std::pair{0.0f, 0.7f}, {0.3f, 0.5f}, {0.2f, 1.3f}, {0.9f, 1.57f}})
        for (const float range : {0.0f, 4.0f}) {
            light.inner_cone_angle = inner;
            light.outer_cone_angle = outer;
            light.range = range;
            EXPECT_GT(expect_unshadowed(device(), scene, camera, std::array{light}, 2e-3), 200) << outer;
        }
}

TEST_P(LightsTest, SeveralLightsAdd) {
    scene::Scene scene;
    add_quad(scene, {0, 0, 0}, {6, 0, 0}, {0, 0, -6}, {});
    std::vector<scene::Light> lights{
        {.intensity = {1, 0, 0}, .direction = glm::normalize(glm::vec3(0.3f, -1, 0.2f))},
        {.intensity = {0, 0.5f, 0}, .direction = glm::normalize(glm::vec3(-0.6f, -1, 0.2f))},
        {.kind = scene::LightKind::point, .intensity = {0, 0, 8}, .position = {2, 2, 1}},
        {.kind = scene::LightKind::spot,
         .intensity = {5, 5, 0},
         .position = {-2, 3, 1},
         .direction = {0, -1, 0}}};
    EXPECT_GT(expect_unshadowed(device(), scene, looking({0, 7, 0}, {0, 0, 0}, {0, 0, -1}), lights, 2e-3),
              int(size.width * size.height / 2));
}

/// The shadow of a square under a point light is the square enlarged from the light.
TEST_P(LightsTest, PointLightCastsShadows) {
    scene::Scene scene;
    add_quad(scene, {0, 0, 0}, {4, 0, 0}, {0, 0, -4}, {});
    add_quad(scene, {0.4f, 1, -0.3f}, {0.25f, 0, 0}, {0, 0, -0.25f}, {});
    const scene::Light light{
        .kind = scene::LightKind::point, .intensity = glm::vec3(3), .position = {0, 2.5f, 0}};
    const scene::Camera camera = looking({0.5f, 0.8f, 1.8f}, {0.6f, 0, -0.5f});
    const RenderedTargets targets =
        render(device(), scene, camera, {.size = size, .lights = {light}, .diffuse_materials = true});
    const double texel = 2.5 * 2 / 2048;
    int in_shadow = 0, in_light = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            const Ray ray = pixel_ray(camera, size, x, y);
            if (ray.direction.y > -0.01 || targets.depth.at(x, y).x == 1) continue;
            const auto at_height = [&](double h) {
                return ray.origin + ray.direction * ((h - ray.origin.y) / ray.direction.y);
            };
            if (ray.origin.y > 1) continue;
            const glm::dvec3 floor = at_height(0);
            if (std::max(std::abs(floor.x), std::abs(floor.z)) > 3.9) continue;
            // Where the ray from the light to the floor passes the square's height.
            const glm::dvec3 passed = glm::mix(glm::dvec3(light.position), floor, 1.5 / 2.5);
            const double distance = std::max(std::abs(passed.x - 0.4), std::abs(passed.z + 0.3)) - 0.25;
            const double direct = double(targets.direct.at(x, y).x);
            if (distance < -3 * texel) {
                ++in_shadow;
                ASSERT_EQ(direct, 0) << x << ", " << y;
            } else if (distance > 3 * texel) {
                ++in_light;
                ASSERT_GT(direct, 0) << x << ", " << y;
            }
        }
    EXPECT_GT(in_shadow, 30);
    EXPECT_GT(in_light, 500);
}

/// At the light itself, behind it and with nothing to light: finite.
TEST_P(LightsTest, ALightOnASurfaceStaysFinite) {
    scene::Scene scene;
    add_quad(scene, {0, 0, 0}, {2, 0, 0}, {0, 0, -2}, {});
    for (const float height : {0.0f, 1e-4f}) {
        const scene::Light light{
            .kind = scene::LightKind::point, .intensity = glm::vec3(1), .position = {0, height, 0}};
        const RenderedTargets targets = render(device(), scene, looking({0, 3, 0}, {0, 0, 0}, {0, 0, -1}),
                                               {.size = size, .lights = {light}});
        for (uint32_t y = 0; y < size.height; ++y)
            for (uint32_t x = 0; x < size.width; ++x)
                ASSERT_TRUE(std::isfinite(targets.direct.at(x, y).x) && targets.direct.at(x, y).x >= 0);
    }
}

}  // namespace
}  // namespace lumo::lighting
