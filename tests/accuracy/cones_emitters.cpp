// Emitters that are lit by one by one: what they add up to, and the light of lamps whose irradiance is known.
#include <cstring>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "techniques/cones/emitters.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct EmittersTest : DeviceTest {
    cones::EmitterBlock emitters_of(const scene::Scene& scene, uint32_t resolution) {
        const Voxelized voxelized = voxelize(
            device(), scene, {.resolution = resolution, .normals = true, .range = voxels::Range::fixed});
        auto emitters = must(cones::Emitters::create(device(), {.resolution = resolution}));
        rhi::Commands commands = device().begin();
        emitters.record(commands, voxelized.volume);
        must(device().wait(device().submit(std::move(commands))));
        const auto bytes = must(device().download(emitters.block()));
        cones::EmitterBlock block{};
        std::memcpy(&block, bytes.data(), sizeof block);
        return block;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, EmittersTest, both_apis, api_name);

/// Radiance times area, in squared voxels.
glm::dvec3 flux_of(const cones::EmitterBlock& block) {
    glm::dvec3 sum(0);
    for (int i = 0; i < block.count; ++i) sum += glm::dvec3(glm::vec3(block.data[i].flux));
    return sum;
}

/// Looks straight down from the height at the floor y = 0, of which it sees a square of this half-side.
scene::Camera down_from(float height, float half_side) {
    return {
        .position = {0, height, 0}, .target = {0, 0, 0}, .vertical_fov = 2 * std::atan(half_side / height)};
}

constexpr float floor_half = 2;

/// A black floor of 4 m.
scene::Scene floor_scene() {
    scene::Scene scene;
    add(scene,
        scene::builtin::parallelogram({-floor_half, 0, floor_half}, {2 * floor_half, 0, 0},
                                      {0, 0, -2 * floor_half}),
        diffuse(glm::vec3(0)));
    return scene;
}

/// A lamp that faces down: its corner of least x and z, its sides along x and z.
struct Lamp {
    glm::dvec3 corner;
    glm::dvec2 size;
};
void add_lamp(scene::Scene& scene, const Lamp& lamp, glm::vec3 radiance) {
    add(scene,
        scene::builtin::parallelogram(glm::vec3(lamp.corner), {float(lamp.size.x), 0, 0},
                                      {0, 0, float(lamp.size.y)}),
        diffuse(glm::vec3(0), radiance));
}

/// Of unit radiance, by the midpoints of a grid; `visible(floor, lamp)`.
template <class Visible>
double irradiance_from(const Lamp& lamp, glm::dvec3 floor, const Visible& visible) {
    constexpr int n = 24;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const glm::dvec3 p =
                lamp.corner + glm::dvec3(lamp.size.x * (i + 0.5) / n, 0, lamp.size.y * (j + 0.5) / n);
            const glm::dvec3 path = p - floor;
            const double squared = glm::dot(path, path);
            if (visible(floor, p)) sum += path.y * path.y / (squared * squared);
        }
    return sum * lamp.size.x * lamp.size.y / (n * n);
}

struct Compared {
    double rmse = 0;  ///< of 4 x 4 blocks, over the mean
    double bias = 0;
};

/// The floor's irradiance, red channel, against `expected(floor point)`.
template <class Expected>
Compared compare_floor(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera,
                       float half_side, uint32_t resolution, const Expected& expected,
                       frame::Gatherer gatherer = frame::Gatherer::cones) {
    constexpr uint32_t side = 48, block = 4;
    frame::Settings settings{
        .size = {side, side}, .diffuse_materials = true, .layers = {frame::Layer::irradiance}};
    settings.voxels.resolution = resolution;
    settings.gatherer = gatherer;
    const frame::Rendered rendered = value_of(frame::render(device, scene, camera, settings));
    double squares = 0, sum = 0, mean = 0;
    for (uint32_t y = 0; y < side; y += block)
        for (uint32_t x = 0; x < side; x += block) {
            double difference = 0;
            for (uint32_t i = 0; i < block * block; ++i) {
                const uint32_t px = x + i % block, py = y + i / block;
                const glm::dvec3 floor((2 * (px + 0.5) / side - 1) * double(half_side), 0,
                                       (2 * (py + 0.5) / side - 1) * double(half_side));
                const double truth = expected(floor);
                difference += (double(rendered.layers[0].linear.at(px, py)[0]) - truth) / (block * block);
                mean += truth;
            }
            squares += difference * difference;
            sum += difference;
        }
    constexpr double blocks = side / block * (side / block);
    mean /= side * side;
    return {std::sqrt(squares / blocks) / mean, sum / blocks / mean};
}

TEST_P(EmittersTest, LampsAddUpToTheirFlux) {
    scene::Scene scene = floor_scene();
    const glm::vec3 radiance{6, 3, 1.5f};
    add_lamp(scene, {{-0.3, 1.9, 0.2}, {0.5, 0.4}}, radiance);
    add_lamp(scene, {{-1.5, 1.1, -1.2}, {0.3, 0.7}}, radiance * 0.5f);
    for (const uint32_t resolution : {32u, 64u, 128u}) {
        const cones::EmitterBlock block = emitters_of(scene, resolution);
        EXPECT_EQ(block.share, 1);
        EXPECT_GE(block.count, 2);
        EXPECT_LE(block.count, 16);
        const double voxel = 2 * double(floor_half) / (resolution - 1);
        const double area = (0.5 * 0.4 + 0.5 * 0.3 * 0.7) / (voxel * voxel);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(flux_of(block)[c], area * double(radiance[c]), 0.08 * area * double(radiance[c]))
                << resolution;
        for (int i = 0; i < block.count; ++i) EXPECT_NEAR(block.data[i].normal.y, -1, 0.02f);
    }
}

TEST_P(EmittersTest, WhereEverythingEmitsFixedConesSeeAll) {
    scene::Scene scene;
    add(scene, scene::builtin::reversed(scene::builtin::box(glm::vec3(-1), glm::vec3(1))),
        diffuse(glm::vec3(0.5f), glm::vec3(2)));
    for (const uint32_t resolution : {16u, 64u}) {
        const cones::EmitterBlock block = emitters_of(scene, resolution);
        EXPECT_EQ(block.share, 0);
        EXPECT_EQ(block.count, 0);
    }
}

/// More and more lamps, each in a coarse cell of its own: their part passes over to the fixed cones bit by bit.
TEST_P(EmittersTest, ManyEmittersPassOverSmoothly) {
    constexpr uint32_t resolution = 64;
    constexpr double voxel = 2 * double(floor_half) / (resolution - 1);
    constexpr double cell = 8 * voxel, origin = -32 * voxel;
    constexpr double lamp_side = 3 * voxel;
    for (const int lamps : {12, 16, 20, 24, 28, 32, 40}) {
        scene::Scene scene = floor_scene();
        add(scene, triangle({0, 3.9f, 0}, {0.1f, 3.9f, 0}, {0, 3.9f, 0.1f}), diffuse(glm::vec3(0)));
        for (int i = 0; i < lamps; ++i) {
            const double x = origin + cell * (i % 8 + 0.5), y = 0.6 + cell * (i / 8);
            add_lamp(scene, {{x - lamp_side / 2, y, 0.1}, {lamp_side, lamp_side}}, glm::vec3(4));
        }
        const cones::EmitterBlock block = emitters_of(scene, resolution);
        EXPECT_FLOAT_EQ(block.share, std::clamp(2 - float(lamps) / 16, 0.0f, 1.0f));
        EXPECT_EQ(block.count, block.share > 0 ? lamps : 0);
        EXPECT_NEAR(flux_of(block).r, 4.0 * 9 * lamps * double(block.share), 0.02 * 4 * 9 * lamps);
    }
}

TEST_P(EmittersTest, LampOverAFloor) {
    scene::Scene scene = floor_scene();
    const Lamp lamp{{-0.3, 1.7, 0.1}, {0.5, 0.4}};
    add_lamp(scene, lamp, glm::vec3(8));
    const auto all = [](const glm::dvec3&, const glm::dvec3&) { return true; };
    const Compared c =
        compare_floor(device(), scene, down_from(1.5f, 1.5f), 1.5f, 64,
                      [&](const glm::dvec3& floor) { return 8 * irradiance_from(lamp, floor, all); });
    RecordProperty("rmse_bias", fmt::format("{:.4f} {:.4f}", c.rmse, c.bias));
    EXPECT_LT(c.rmse, 0.05);
    // Eight voxels wide: an edge that is half a voxel off is as much.
    EXPECT_LT(std::abs(c.bias), 0.05);
}

/// Far above a floor and near it, where most of what shows is seen aslant; in coarse voxels and in fine ones, of which the
/// sphere has more.
TEST_P(EmittersTest, SphereOverAFloor) {
    constexpr double radius = 0.3;
    struct Case {
        double height;
        uint32_t resolution;
        double rmse, bias;
    };
    for (const auto& [height, resolution, rmse, bias] : {Case{1.9, 64, 0.055, 0.03},
                                                         {1.9, 128, 0.08, 0.06},
                                                         {0.6, 64, 0.23, 0.13},
                                                         {0.6, 128, 0.21, 0.11}}) {
        scene::Scene scene = floor_scene();
        const glm::dvec3 center(0.2, height, -0.1);
        add(scene, scene::builtin::sphere(float(radius), 32, 16), diffuse(glm::vec3(0), glm::vec3(8)),
            scene::builtin::translation(glm::vec3(center)));
        // Just below the sphere.
        const double camera_height = 0.9 * (height - radius);
        const Compared c = compare_floor(device(), scene, down_from(float(camera_height), 1.4f), 1.4f,
                                         resolution, [&](const glm::dvec3& floor) {
                                             const double squared = glm::dot(center - floor, center - floor);
                                             return 8 * glm::pi<double>() * radius * radius * height /
                                                    (squared * std::sqrt(squared));
                                         });
        const std::string figures = fmt::format("{:.4f} {:.4f}", c.rmse, c.bias);
        RecordProperty(fmt::format("at_{}_of_{}", int(10 * height), resolution), figures);
        EXPECT_LT(c.rmse, rmse) << height << " " << resolution << " " << figures;
        EXPECT_LT(std::abs(c.bias), bias) << height << " " << resolution << " " << figures;
    }
}

TEST_P(EmittersTest, ASphereDoesNotLightItself) {
    for (const uint32_t resolution : {32u, 64u, 128u}) {
        scene::Scene scene = floor_scene();
        add(scene, scene::builtin::sphere(0.4f, 32, 16), diffuse(glm::vec3(0), glm::vec3(8)),
            scene::builtin::translation({0.2f, 1.2f, -0.1f}));
        const scene::Camera camera{
            .position = {0.2f, 1.2f, 1.5f}, .target = {0.2f, 1.2f, -0.1f}, .vertical_fov = 0.3f};
        frame::Settings settings{
            .size = {16, 16}, .diffuse_materials = true, .layers = {frame::Layer::irradiance}};
        settings.voxels.resolution = resolution;
        const frame::Rendered rendered = value_of(frame::render(device(), scene, camera, settings));
        double mean = 0;
        for (uint32_t y = 0; y < 16; ++y)
            for (uint32_t x = 0; x < 16; ++x) mean += double(rendered.layers[0].linear.at(x, y)[0]) / 256;
        RecordProperty(fmt::format("of_{}", resolution), fmt::format("{:.4f}", mean));
        EXPECT_LT(mean, 0.001 * 8 * glm::pi<double>()) << resolution;
    }
}

/// A plate half-way casts a shadow with a penumbra.
TEST_P(EmittersTest, LampBehindAPlate) {
    scene::Scene scene = floor_scene();
    const Lamp lamp{{-0.315, 1.7, -0.315}, {0.63, 0.63}};  // whole voxels
    add_lamp(scene, lamp, glm::vec3(8));
    constexpr double plate_half = 0.4, plate_height = 0.75, camera_height = 0.7;
    add(scene,
        scene::builtin::box({-float(plate_half), 0.72f, -float(plate_half)},
                            {float(plate_half), 0.78f, float(plate_half)}),
        diffuse(glm::vec3(0)));
    const auto past_plate = [&](const glm::dvec3& floor, const glm::dvec3& p) {
        const glm::dvec3 at = floor + (p - floor) * (plate_height / p.y);
        return std::abs(at.x) > plate_half || std::abs(at.z) > plate_half;
    };
    struct Bounds {
        frame::Gatherer gatherer;
        double rmse, bias;
    };
    // Rays take the plate as as wide as its voxels.
    for (const Bounds& most :
         {Bounds{frame::Gatherer::cones, 0.10, 0.04}, Bounds{frame::Gatherer::rays, 0.12, 0.06}}) {
        const Compared c = compare_floor(
            device(), scene, down_from(float(camera_height), 1.8f), 1.8f, 128,
            [&](const glm::dvec3& floor) { return 8 * irradiance_from(lamp, floor, past_plate); },
            most.gatherer);
        RecordProperty(fmt::format("rmse_bias_{}", int(most.gatherer)),
                       fmt::format("{:.4f} {:.4f}", c.rmse, c.bias));
        EXPECT_LT(c.rmse, most.rmse);
        EXPECT_LT(std::abs(c.bias), most.bias);
    }
}

}  // namespace
}  // namespace lumo
