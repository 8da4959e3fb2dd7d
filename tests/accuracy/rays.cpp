// Many rays through the finest voxels, against closed forms.
#include "techniques/cones/rays.hpp"

#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct RaysTest : DeviceTest {
    /// Its irradiance, then its depth.
    std::vector<scene::ImageF> render(const scene::Scene& scene, frame::Settings settings) {
        settings.gatherer = frame::Gatherer::floor;
        settings.diffuse_materials = true;
        settings.layers = {frame::Layer::irradiance, frame::Layer::depth};
        const auto rendered = must(frame::render(device(), scene, scene::default_camera(scene), settings));
        return {rendered.layers[0].linear, rendered.layers[1].linear};
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, RaysTest, both_apis, api_name);

/// Of a convex body nothing hides the environment, and no ray meets the voxels of the surface that it leaves.
TEST_P(RaysTest, ConvexBodyReceivesTheWholeEnvironment) {
    const scene::Scene scene = value_of(scene::make_builtin("furnace"));
    for (const uint32_t resolution : {16u, 64u}) {
        frame::Settings settings{.size = {32, 24}, .rays = 33};
        settings.voxels.resolution = resolution;
        const auto pictures = render(scene, settings);
        int drawn = 0;
        for (uint32_t y = 0; y < 24; ++y)
            for (uint32_t x = 0; x < 32; ++x) {
                const bool hit = *pictures[1].at(x, y) > 0;
                drawn += hit;
                for (int c = 0; c < 3; ++c) {
                    const float expected = hit ? glm::pi<float>() * scene.environment_radiance[c] : 0;
                    ASSERT_NEAR(pictures[0].at(x, y)[c], expected, 1e-5f * expected) << x << ' ' << y;
                }
            }
        EXPECT_GT(drawn, 100);
    }
}

/// In a closed room whose walls glow alike every ray ends at a wall: more rays than one dispatch has, in either storage.
TEST_P(RaysTest, ClosedRoomThatGlowsGivesPiTimesItsRadiance) {
    constexpr glm::vec3 radiance{2, 0.5f, 8};
    scene::Scene scene;
    add(scene, reversed(scene::builtin::box({-1, -1, -1}, {1, 1, 1})), diffuse(glm::vec3(0), radiance));
    scene.cameras.push_back({.position = {0.3f, 0.2f, 0.7f}, .target = {-1, -0.3f, -1}, .vertical_fov = 1});
    for (const voxels::Storage storage : {voxels::Storage::dense, voxels::Storage::octree}) {
        frame::Settings settings{.size = {8, 6}, .rays = 2000};
        settings.voxels = {.resolution = 32, .storage = storage};
        const auto pictures = render(scene, settings);
        for (uint32_t y = 0; y < 6; ++y)
            for (uint32_t x = 0; x < 8; ++x)
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(pictures[0].at(x, y)[c], glm::pi<float>() * radiance[c],
                                0.01f * glm::pi<float>() * radiance[c])
                        << x << ' ' << y;
    }
}

/// A plane in the sun does not see itself, however it lies in the grid; not a ray of it.
TEST_P(RaysTest, LitPlaneSeesNothingOfItself) {
    for (const float angle : {0.0f, 0.3f, 0.5f, 0.785f}) {
        scene::Scene scene;
        add(scene, scene::builtin::parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.8f)),
            glm::rotate(glm::mat4(1), angle, glm::vec3(1, 0, 0.5f)));
        scene.lights.push_back({.intensity = glm::vec3(glm::pi<float>()), .direction = {0, -1, 0}});
        scene.cameras.push_back({.position = {0, 5, 0}, .target = {0, 0, 0}, .vertical_fov = 0.25f});
        frame::Settings settings{.size = {24, 24}, .rays = 64};
        settings.voxels.resolution = 64;
        const auto pictures = render(scene, settings);
        for (const float value : pictures[0].values) ASSERT_EQ(value, 0) << angle;
    }
}

/// Irradiance in the middle below a square of side 2 a at height h that faces it, of radiance 1: four times that of a
/// corner (e.g. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-4).
double square_above(double a, double h) {
    const double x = a / h, root = std::sqrt(1 + x * x);
    return 4 * x / root * std::atan(x / root);
}

/// A plate under a sunlit square, at its middle: between the closed forms for the square as it is, and for one that is as
/// near as the faces of voxels may be, from as high as rays start, and half a voxel wider. Beside it, 2 % for what the
/// shadow map's texels bring.
TEST_P(RaysTest, ReflectedLightOfALitSquare) {
    constexpr float half = 1, height = 0.75f, albedo = 0.5f;
    constexpr glm::vec3 up{0.9284767f, 0.3713907f, 0};  // past the plate
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({-half, height, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}),
        diffuse(glm::vec3(albedo)));
    add(scene, scene::builtin::parallelogram({-0.1f, 0, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}),
        diffuse(glm::vec3(albedo)));
    scene.lights.push_back({.intensity = glm::vec3(glm::pi<float>() / up.y), .direction = up});
    scene.cameras.push_back({.position = {0, 0.5f, 0}, .target = {0, 0, 0}, .vertical_fov = 0.1f});
    frame::Settings settings{.size = {8, 8}, .rays = 256};
    settings.voxels.resolution = 128;
    double sum = 0;
    const auto pictures = render(scene, settings);
    for (const float value : pictures[0].values) sum += double(value);
    const double mean = sum / double(pictures[0].values.size());
    const double voxel = 2 * half / 127;
    const double least = albedo * square_above(half, height);
    const double most = albedo * square_above(half + voxel / 2, height - 2 * voxel);
    RecordProperty("irradiance", fmt::format("{:.4f}, {:.4f} to {:.4f}", mean, least, most));
    EXPECT_GT(mean, 0.98 * least);
    EXPECT_LT(mean, 1.02 * most);
}

}  // namespace
}  // namespace lumo
