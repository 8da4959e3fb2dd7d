// What each range makes of the fragments in a voxel, against their mean in double precision; what it loses.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

#include "tests/support/voxelize_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using voxels::Range;

struct VoxelRangeTest : VoxelizerTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, VoxelRangeTest, each_voxelizer, voxelizer_name);

constexpr uint32_t side = 32;
constexpr float voxel = 2.0f / 31;  // of a grid around [-1, 1]³, whose voxels 16 begin at 0
constexpr int slab = 8;             // voxels a side of what a layer covers
constexpr int first = 12;           // voxel where a layer begins in x and y

/// Layers over the same 8 x 8 voxels, within voxel `depth` along z: each of these voxels has a fragment of full weight
/// of each.
void add_layers(scene::Scene& scene, int depth, const std::vector<glm::vec3>& colors, glm::vec3 emission) {
    scene::builtin::Geometry geometry;
    const float low = voxel * float(first - 16), high = voxel * float(first + slab - 16);
    for (size_t i = 0; i < colors.size(); ++i) {
        const float z = voxel * (float(depth - 16) + 0.1f + 0.8f * (float(i) + 0.5f) / float(colors.size()));
        const auto corner = uint32_t(geometry.vertices.size());
        for (const glm::vec2 p : {glm::vec2(low, low), {high, low}, {high, high}, {low, high}})
            geometry.vertices.push_back(
                {.position = glm::vec3(p, z), .normal = {0, 0, 1}, .color = glm::vec4(colors[i], 1)});
        for (const uint32_t c : {0u, 1u, 2u, 0u, 2u, 3u}) geometry.indices.push_back(corner + c);
    }
    add(scene, geometry, diffuse(glm::vec3(1), emission));
}

/// So that the grid is the one above: specks in its corners.
void add_bounds(scene::Scene& scene) {
    for (const glm::vec3 corner : {glm::vec3(-1), glm::vec3(1)})
        add(scene, triangle(corner, corner * glm::vec3(0.999f, 1, 1), corner * glm::vec3(1, 0.999f, 1)),
            diffuse(glm::vec3(0.5f)));
}

std::vector<glm::vec3> random_colors(size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<glm::vec3> colors(count);
    for (glm::vec3& color : colors)
        color = {uniform(random), 0.2f * uniform(random), 0.02f * uniform(random)};
    return colors;
}

glm::dvec3 mean_of(const std::vector<glm::vec3>& colors) {
    glm::dvec3 sum(0);
    for (const glm::vec3& color : colors) sum += glm::dvec3(color);
    return sum / double(colors.size());
}

uint32_t dropped_by(rhi::Device& device, const voxels::Volume& volume) {
    return values_of<uint32_t>(must(device.download(volume.dropped_writes())))[0];
}

/// The voxels that layers at a depth cover.
template <class Visit>
void for_each_voxel(int depth, const Visit& visit) {
    for (int y = first; y < first + slab; ++y)
        for (int x = first; x < first + slab; ++x) visit(glm::ivec3(x, y, depth));
}

struct Error {
    glm::dvec3 bias{0};  ///< mean difference
    double largest = 0;  ///< absolute
};

TEST_P(VoxelRangeTest, EachRangeHasTheMeanOfItsFragments) {
    const std::vector<glm::vec3> colors = random_colors(500);
    const glm::dvec3 mean = mean_of(colors);
    scene::Scene scene;
    add_bounds(scene);
    add_layers(scene, 16, colors, glm::vec3(0));
    for (const Range range : voxels::all_ranges) {
        SCOPED_TRACE(to_string(range));
        const Voxelized made = voxelized(scene, {.resolution = side, .range = range});
        const VolumeTexels albedo = read_volume(device(), made.volume.albedo());
        const voxels::Sums& sums = made.volume.sums();
        const auto floats =
            values_of<float>(must(device().download(sums.floats(), whole_mip(sums.floats().desc()))));
        Error error;
        double lost = 0;
        for_each_voxel(16, [&](glm::ivec3 v) {
            const glm::dvec3 d = glm::dvec3(albedo.at(v)) - mean;
            error.bias += d / double(slab * slab);
            // A voxel's mean lacks what was dropped: by no more than its part, since colours are 0 to 1.
            double missing = 0;
            if (range == Range::mutex) {
                const size_t i = (size_t(v.z) * side + size_t(v.y)) * side + size_t(v.x);
                missing = 1 - double(floats[4 * i + 3]) / (64.0 * double(colors.size()));
                lost += missing * double(colors.size());
            }
            error.largest =
                std::max(error.largest, std::max({std::abs(d.r), std::abs(d.g), std::abs(d.b)}) - missing);
        });
        RecordProperty(fmt::format("bias_{}", to_string(range)),
                       fmt::format("{:.5f} {:.5f} {:.5f}", error.bias.r, error.bias.g, error.bias.b));
        RecordProperty(fmt::format("largest_{}", to_string(range)), fmt::format("{:.5f}", error.largest));
        // Half a step of what is stored, and what the sums may err by themselves: integers and floats, half a step of
        // what goes in. A running mean of 8 bits stays where it is once a fragment moves it by less than half a step.
        // A sum of 8 bits goes up by a step as often as is right: no bias, but the noise of some 200 steps.
        const double step = 1.0 / 255;
        const bool noisy = range == Range::rgbe, drifts = range == Range::average;
        const uint32_t dropped = dropped_by(device(), made.volume);
        EXPECT_LE(error.largest, noisy ? 0.12 : drifts ? 0.02 : 0.75 * step);
        const double missing = double(dropped) / double(colors.size() * slab * slab);
        const glm::dvec3 bias = glm::abs(error.bias);
        EXPECT_LE(std::max({bias.r, bias.g, bias.b}), noisy ? 0.02 : drifts ? 0.02 : 0.75 * step + missing);
        if (range == Range::mutex) {
            EXPECT_DOUBLE_EQ(lost, double(dropped));
        } else {
            EXPECT_EQ(dropped, 0u);
        }
    }
}

TEST_P(VoxelRangeTest, NothingIsLostUnderContention) {
    // Every fragment the same: what is missing in a sum is missing in number.
    constexpr size_t count = 10'000;
    scene::Scene scene;
    add_bounds(scene);
    add_layers(scene, 16, std::vector<glm::vec3>(count, glm::vec3(1)), glm::vec3(0));
    for (const Range range : {Range::fixed, Range::rgbe, Range::mutex, Range::ldr}) {
        SCOPED_TRACE(to_string(range));
        const Voxelized made = voxelized(scene, {.resolution = side, .range = range});
        const voxels::Sums& sums = made.volume.sums();
        const uint32_t dropped = dropped_by(device(), made.volume);
        RecordProperty(fmt::format("dropped_{}", to_string(range)), std::to_string(dropped));
        const auto words =
            values_of<uint32_t>(must(device().download(sums.sums(), whole_mip(sums.sums().desc()))));
        const auto exchanged = values_of<uint32_t>(
            must(device().download(sums.exchanged(), whole_mip(sums.exchanged().desc()))));
        const auto floats =
            values_of<float>(must(device().download(sums.floats(), whole_mip(sums.floats().desc()))));
        const size_t words_a_voxel = words.size() / (size_t(side) * side * side);
        double locked = 0;
        for_each_voxel(16, [&](glm::ivec3 v) {
            const size_t i = (size_t(v.z) * side + size_t(v.y)) * side + size_t(v.x);
            EXPECT_EQ(words[i * words_a_voxel], 64 * count);
            if (is_order_free(range)) {
                EXPECT_EQ(words[i * words_a_voxel + 1], 64 * 255 * count);
            } else if (range == Range::rgbe) {
                const double sum = double(exchanged[i] & 255) * std::exp2(double(exchanged[i] >> 24) - 136);
                EXPECT_NEAR(sum / (64.0 * count), 1, 0.3);
            } else {
                locked += double(floats[4 * i + 3]) / 64;
            }
        });
        if (range == Range::mutex) {
            EXPECT_EQ(locked + dropped, double(slab * slab) * count);
        } else {
            EXPECT_EQ(dropped, 0u);
        }
    }
}

TEST_P(VoxelRangeTest, EmissionIsHeldAsFarAsItsRangeGoes) {
    // Twelve decades in one scene.
    scene::Scene scene;
    add_bounds(scene);
    for (int decade = -6; decade <= 6; ++decade)
        add_layers(scene, 16 + 2 * decade, std::vector<glm::vec3>(3, glm::vec3(0.5f)),
                   glm::vec3(1, 0.5f, 0.1f) * std::pow(10.0f, float(decade)));
    for (const Range range : voxels::all_ranges) {
        const Voxelized made = voxelized(scene, {.resolution = side, .range = range});
        const VolumeTexels emission = read_volume(device(), made.volume.emission().base);
        const double unit = double(made.volume.view().emission_unit);
        for (int decade = -6; decade <= 6; ++decade) {
            SCOPED_TRACE(fmt::format("{}, 1e{}", to_string(range), decade));
            const glm::dvec3 truth = glm::dvec3(1, 0.5, 0.1) * std::pow(10.0, decade);
            for_each_voxel(16 + 2 * decade, [&](glm::ivec3 v) {
                const glm::dvec3 stored = glm::dvec3(emission.at(v)) * unit;
                for (int c = 0; c < 3; ++c) {
                    ASSERT_TRUE(std::isfinite(stored[c]));
                    if (!is_wide(range)) {
                        EXPECT_NEAR(stored[c], std::min(truth[c], 1.0), 0.51 / 255);
                        continue;
                    }
                    // 11 bits down to 2^-22 of the highest, then a step of half floats; rgbe has 8 bits of the largest
                    // channel.
                    const double mantissa = range == Range::rgbe ? 0.015 * truth.r : truth[c] / 1024;
                    EXPECT_NEAR(stored[c], truth[c], mantissa + 1e6 * std::exp2(-32));
                }
            });
        }
    }
}

TEST_P(VoxelRangeTest, EveryTexelOfLightIsFinite) {
    // Twelve decades, a sun, and a lamp that touches what it lights.
    scene::Scene scene;
    add_bounds(scene);
    for (int decade = -6; decade <= 6; ++decade)
        add_layers(scene, 16 + 2 * decade, std::vector<glm::vec3>(3, glm::vec3(1)),
                   glm::vec3(1, 0.5f, 0.1f) * std::pow(10.0f, float(decade)));
    const scene::Light lamp{.kind = scene::LightKind::point,
                            .intensity = glm::vec3(1e6f, 1, 1e-6f),
                            .position = {0.02f, 0.02f, 0.051f}};
    for (const Range range : voxels::all_ranges)
        for (const auto mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic}) {
            SCOPED_TRACE(to_string(range));
            const Voxelized made = voxelized(scene, {.resolution = side,
                                                     .sun = Sun{{0.1f, 0.2f, 1}, glm::vec3(1e6f)},
                                                     .lights = {lamp},
                                                     .normals = true,
                                                     .range = range,
                                                     .mips = mips});
            const voxels::LightVolume& radiance = made.volume.radiance();
            const voxels::LightVolume& emission = made.volume.emission();
            for (const rhi::Texture* texture :
                 {&radiance.base, &radiance.directions, &emission.base, &emission.directions}) {
                if (!*texture) continue;
                for (uint32_t mip = 0; mip < texture->desc().mips; ++mip) {
                    size_t wrong = 0;
                    for (const glm::vec4& texel : read_volume(device(), *texture, mip).texels)
                        for (int c = 0; c < 4; ++c) wrong += !(texel[c] >= 0 && texel[c] < 1e30f);
                    EXPECT_EQ(wrong, 0u) << texture->desc().name << " mip " << mip;
                }
            }
        }
}

TEST(VoxelRangeParity, FixedIsTheSameToTheBit) {
    auto gl = open_device(rhi::Api::gl), vulkan = open_device(rhi::Api::vulkan);
    if (!gl || !vulkan) GTEST_SKIP() << "one of the APIs has no device";
    scene::Scene scene;
    add_bounds(scene);
    add_layers(scene, 16, random_colors(100), {3, 1e-3f, 1e4f});
    add_layers(scene, 16, random_colors(50), {1e-6f, 1e6f, 0.1f});
    const auto bytes = [&](CheckedDevice& checked, voxels::VoxelizerKind voxelizer) {
        const Voxelized made = voxelize(*checked.device, scene,
                                        {.resolution = side, .range = Range::fixed, .voxelizer = voxelizer});
        return read_volume(*checked.device, made.volume.emission().base).bytes;
    };
    for (const auto voxelizer : {voxels::VoxelizerKind::raster, voxels::VoxelizerKind::compute})
        EXPECT_EQ(bytes(*gl, voxelizer), bytes(*vulkan, voxelizer));
}

}  // namespace
}  // namespace lumo
