// Rays through the finest voxels, few with a mean over a pattern and many without, against closed forms.
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

constexpr frame::Gatherer gatherers[] = {frame::Gatherer::rays, frame::Gatherer::floor};

struct RaysTest : DeviceTest {
    /// Its irradiance, then its depth.
    std::vector<scene::ImageF> render(const scene::Scene& scene, frame::Settings settings,
                                      frame::Gatherer gatherer = frame::Gatherer::rays) {
        settings.gatherer = gatherer;
        settings.diffuse_materials = true;
        settings.layers = {frame::Layer::irradiance, frame::Layer::depth};
        const auto rendered = must(frame::render(device(), scene, scene::default_camera(scene), settings));
        return {rendered.layers[0].linear, rendered.layers[1].linear};
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, RaysTest, both_apis, api_name);

/// Of a convex body nothing hides the environment, and no ray meets the voxels of the surface that it leaves: its irradiance
/// is exact, with one ray a pixel as with many.
TEST_P(RaysTest, ConvexBodyReceivesTheWholeEnvironment) {
    const scene::Scene scene = value_of(scene::make_builtin("furnace"));
    for (const frame::Gatherer gatherer : gatherers)
        for (const auto& [resolution, rays] : {std::pair(16u, 1u), std::pair(16u, 33u), std::pair(64u, 4u)}) {
            frame::Settings settings{.size = {32, 24}, .rays = rays};
            settings.voxels.resolution = resolution;
            const auto pictures = render(scene, settings, gatherer);
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
        const auto pictures = render(scene, settings, frame::Gatherer::floor);
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
        for (const frame::Gatherer gatherer : gatherers) {
            const auto pictures = render(scene, settings, gatherer);
            for (const float value : pictures[0].values) ASSERT_EQ(value, 0) << angle;
        }
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
    const double voxel = 2 * half / 127;
    const double least = albedo * square_above(half, height);
    const double most = albedo * square_above(half + voxel / 2, height - 2 * voxel);
    for (const frame::Gatherer gatherer : gatherers) {
        double sum = 0;
        const auto pictures = render(scene, settings, gatherer);
        for (const float value : pictures[0].values) sum += double(value);
        const double mean = sum / double(pictures[0].values.size());
        RecordProperty(fmt::format("irradiance_{}", int(gatherer)),
                       fmt::format("{:.4f}, {:.4f} to {:.4f}", mean, least, most));
        EXPECT_GT(mean, 0.98 * least);
        EXPECT_LT(mean, 1.02 * most);
    }
}

/// What the pixels of a floor are from the closed form, as parts of the mean.
struct FloorErrors {
    double blocks = 0;  ///< of 4 x 4, RMS
    double pixels = 0;  ///< RMS
    double bias = 0;
};

/// A black floor at the foot of a black wall under an even sky, from straight above the middle of the wall. At the foot the
/// wall hides half of the sky.
constexpr float wall_height = 1, wall_half = 3, seen_from = 0.1f, seen = 0.8f;
scene::Scene half_space() {
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({0, 0, wall_half}, {1, 0, 0}, {0, 0, -2 * wall_half}),
        diffuse(glm::vec3(0)));
    add(scene, scene::builtin::parallelogram({0, 0, wall_half}, {0, 0, -2 * wall_half}, {0, wall_height, 0}),
        diffuse(glm::vec3(0)));
    scene.environment_radiance = glm::vec3(1);
    scene.cameras.push_back({.position = {seen_from + seen / 2, 5, 0},
                             .target = {seen_from + seen / 2, 0, 0},
                             .up = {0, 0, -1},
                             .vertical_fov = 2 * std::atan(seen / 10)});
    return scene;
}

/// The part of the irradiance that a rectangle hides which stands on the floor, from d before one of its lower corners
/// (Howell, B-5).
double hidden_by(double length, double height, double d) {
    const double up = std::hypot(d, height);
    return (std::atan(length / d) - d / up * std::atan(length / up)) / (2 * glm::pi<double>());
}

FloorErrors floor_errors(const scene::ImageF& irradiance) {
    FloorErrors errors;
    double mean = 0;
    const uint32_t side = irradiance.width;
    for (uint32_t y = 0; y < side; y += 4)
        for (uint32_t x = 0; x < side; x += 4) {
            double block = 0;
            for (uint32_t i = 0; i < 16; ++i) {
                const auto along = [&](uint32_t pixel) { return double(seen) * (pixel + 0.5) / side; };
                const double d = double(seen_from) + along(x + i % 4);
                const double z = along(y + i / 4) - double(seen) / 2;
                const double hidden = hidden_by(double(wall_half) - z, double(wall_height), d) +
                                      hidden_by(double(wall_half) + z, double(wall_height), d);
                const double truth = glm::pi<double>() * (1 - hidden);
                const double error = double(*irradiance.at(x + i % 4, y + i / 4)) - truth;
                errors.pixels += error * error;
                errors.bias += error;
                mean += truth;
                block += error / 16;
            }
            errors.blocks += 16 * block * block;
        }
    const double count = double(side) * side;
    mean /= count;
    return {std::sqrt(errors.blocks / count) / mean, std::sqrt(errors.pixels / count) / mean,
            errors.bias / count / mean};
}

/// The more rays the nearer, and the mean over the pattern takes most of the noise; what is left is the voxels'.
TEST_P(RaysTest, HalfOfTheSkyAndWhatNoiseIsLeft) {
    const scene::Scene scene = half_space();
    double before = 1;
    for (const uint32_t rays : {1u, 16u}) {
        frame::Settings settings{.size = {48, 48}, .rays = rays};
        settings.voxels.resolution = 128;
        const FloorErrors smooth = floor_errors(render(scene, settings)[0]);
        const FloorErrors rough = floor_errors(render(scene, settings, frame::Gatherer::floor)[0]);
        RecordProperty(fmt::format("rms_{}", rays),
                       fmt::format("smoothed {:.4f} ({:.4f}), bias {:.4f}; not {:.4f} ({:.4f})",
                                   smooth.pixels, smooth.blocks, smooth.bias, rough.pixels, rough.blocks));
        EXPECT_LT(smooth.pixels, before);
        EXPECT_LT(smooth.pixels, 0.5 * rough.pixels);
        before = smooth.pixels;
    }
    EXPECT_LT(before, 0.04);
}

/// Light in a closed box is neither made nor lost, however much of what emits is lit by one by one: all of it (a lamp), a
/// part, or nothing (a whole wall). Irradiance over the box is emitted flux times the sum of albedo^i, over its area;
/// cameras in its middle see each point of a face alike.
TEST_P(RaysTest, LightOfAWallThatEmitsCountsOnce) {
    constexpr float albedo = 0.5f, radiance = 3;
    const scene::Material wall = diffuse(glm::vec3(albedo));
    const scene::Material lamp = diffuse(glm::vec3(albedo), glm::vec3(radiance));
    const auto add_ceiling = [](scene::Scene& scene, glm::vec2 from, glm::vec2 to,
                                const scene::Material& material) {
        if (from.x < to.x && from.y < to.y)
            add(scene,
                scene::builtin::parallelogram({from.x, 1, from.y}, {to.x - from.x, 0, 0},
                                              {0, 0, to.y - from.y}),
                material);
    };
    struct Case {
        glm::vec2 half;
        uint32_t bounces;
    };
    for (const auto& [half, bounces] :
         {Case{glm::vec2(0.2f), 2}, Case{{0.45f, 0.65f}, 3}, Case{glm::vec2(1), 1}}) {
        scene::Scene scene;
        add_ceiling(scene, -half, half, lamp);
        add_ceiling(scene, {-1, -1}, {1, -half.y}, wall);
        add_ceiling(scene, {-1, half.y}, {1, 1}, wall);
        add_ceiling(scene, {-1, -half.y}, {-half.x, half.y}, wall);
        add_ceiling(scene, {half.x, -half.y}, {1, half.y}, wall);
        add(scene, scene::builtin::parallelogram({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}), wall);
        add(scene, scene::builtin::parallelogram({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), wall);
        add(scene, scene::builtin::parallelogram({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}), wall);
        add(scene, scene::builtin::parallelogram({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}), wall);
        add(scene, scene::builtin::parallelogram({1, -1, -1}, {0, 0, 2}, {0, 2, 0}), wall);
        frame::Settings settings{.size = {16, 16}, .bounces = bounces};
        settings.voxels.resolution = 32;
        double sum = 0;
        // Opposite walls are alike.
        for (const auto& [toward, faces] :
             {std::pair(glm::vec3(0, 1, 0), 1.0), std::pair(glm::vec3(0, -1, 0), 1.0),
              std::pair(glm::vec3(1, 0, 0), 2.0), std::pair(glm::vec3(0, 0, 1), 2.0)}) {
            scene.cameras = {{.position = glm::vec3(0),
                              .target = toward,
                              .up = toward.y != 0 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0),
                              .vertical_fov = glm::half_pi<float>()}};
            const auto pictures = render(scene, settings);
            for (const float value : pictures[0].values)
                sum += faces * double(value) / double(pictures[0].values.size());
        }
        double series = 0;
        for (uint32_t i = 0; i <= bounces; ++i) series += std::pow(double(albedo), i);
        const double expected = glm::pi<double>() * double(radiance * half.x * half.y) * series;
        RecordProperty(fmt::format("half_{}_bounces_{}", int(100 * half.x), bounces),
                       fmt::format("{:.4f} of {:.4f}", sum, expected));
        EXPECT_NEAR(sum / expected, 1, 0.1) << half.x << ", " << bounces;
    }
}

/// An octree has the same voxels, and more blocks to walk through.
TEST_P(RaysTest, AnOctreeGivesTheSameLight) {
    for (const char* name : {"cornell", "atrium"}) {
        const scene::Scene scene = value_of(scene::make_builtin(name));
        frame::Settings settings{.size = {48, 27}};
        settings.voxels.resolution = 32;
        const auto dense = render(scene, settings);
        settings.voxels.storage = voxels::Storage::octree;
        const auto sparse = render(scene, settings);
        double difference = 0, sum = 0;
        for (size_t i = 0; i < dense[0].values.size(); ++i) {
            difference += std::abs(double(dense[0].values[i]) - double(sparse[0].values[i]));
            sum += double(dense[0].values[i]);
        }
        RecordProperty(name, fmt::format("{:.1e}", difference / sum));
        EXPECT_GT(sum, 0);
        EXPECT_LT(difference, 1e-3 * sum) << name;
    }
}

/// Nothing, and a grid that the camera and all that it sees are outside of.
TEST_P(RaysTest, NothingToMeet) {
    for (const uint32_t rays : {1u, 40u}) {
        frame::Settings settings{.size = {17, 9}, .rays = rays};
        settings.voxels.resolution = 16;
        const scene::Scene empty;
        const auto nothing = render(empty, settings);
        for (const float value : nothing[0].values) ASSERT_EQ(value, 0);

        scene::Scene far;
        add(far, scene::builtin::parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.8f)));
        far.environment_radiance = glm::vec3(2);
        far.cameras.push_back({.position = {0, 50, 0.01f}, .target = {0, 0, 0}, .vertical_fov = 0.01f});
        settings.voxels.grid_size = 4;
        const auto outside = render(far, settings);
        for (const float value : outside[0].values) ASSERT_NEAR(value, 2 * glm::pi<float>(), 1e-4f);
    }
}

}  // namespace
}  // namespace lumo
