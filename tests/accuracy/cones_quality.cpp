// The known faults of cone tracing by number: light that leaks through thin walls, bands from steps, two sides of a
// wall that mix. Bounds are what was measured and a little more, so that a change for the worse fails.
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
using scene::builtin::box;
using scene::builtin::parallelogram;

constexpr uint32_t resolution = 64;
constexpr voxels::MipKind kinds[] = {voxels::MipKind::isotropic, voxels::MipKind::anisotropic};

const char* name_of(voxels::MipKind kind) {
    return kind == voxels::MipKind::isotropic ? "isotropic" : "anisotropic";
}

struct ConesQualityTest : DeviceTest {
    /// Irradiance from emission and one reflection at most, over a square of floor seen from straight above, row 0 at
    /// the top.
    scene::ImageF irradiance(scene::Scene scene, const scene::Camera& camera, voxels::MipKind mips,
                             rhi::Extent size, cones::Settings cones = {}) {
        scene.cameras = {camera};
        frame::Settings settings{
            .size = size, .diffuse_materials = true, .layers = {frame::Layer::irradiance}};
        settings.voxels.resolution = resolution;
        settings.voxels.mips = mips;
        settings.cones = cones;
        return must(frame::render(device(), scene, camera, settings)).layers[0].linear;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, ConesQualityTest, both_apis, api_name);

scene::Camera from_above(glm::vec3 target, float width) {
    return {.position = target + glm::vec3(0, 1, 0),
            .target = target,
            .up = {0, 0, -1},
            .vertical_fov = 2 * std::atan(0.5f * width)};
}

double mean(const scene::ImageF& image) {
    double sum = 0;
    for (const float v : image.values) sum += double(v);
    return sum / double(image.values.size());
}

/// A lit wall 0.4 m before a dark wall of some thickness, a black floor behind it. All turned about y.
scene::Scene divided(float wall, float turn) {
    scene::Scene scene;
    const glm::mat4 turned = glm::rotate(glm::mat4(1), turn, glm::vec3(0, 1, 0));
    // Its bounds are the grid's, so that all scenes have the same.
    add(scene, box({-1.5f, -1.5f, -1.5f}, {1.5f, -1.49f, 1.5f}), diffuse(glm::vec3(0)));
    add(scene, box({-1.5f, 1.49f, -1.5f}, {1.5f, 1.5f, 1.5f}), diffuse(glm::vec3(0)));
    add(scene, parallelogram({0, 0, 0.7f}, {0.9f, 0, 0}, {0, 0, -1.4f}), diffuse(glm::vec3(0)), turned);
    add(scene, box({-0.42f, -0.9f, -0.9f}, {-0.4f, 0.9f, 0.9f}), diffuse(glm::vec3(0), glm::vec3(1)), turned);
    if (wall > 0) add(scene, box({-wall, -1.3f, -1}, {0, 1.3f, 1}), diffuse(glm::vec3(0)), turned);
    return scene;
}

/// Light that arrives behind a wall, as a share of what arrives without it. The wall is hollow; what is turned by 45
/// degrees lies in voxels as a staircase.
TEST_P(ConesQualityTest, LittleLightLeaksThroughThinWalls) {
    constexpr float voxel = 3.0f / (resolution - 1);
    struct Case {
        float voxels;
        float turn;
        double most[2];  ///< isotropic, anisotropic
    };
    for (const Case& c :
         {Case{1, 0, {0.05, 0.001}}, Case{2, 0, {0.06, 0.005}}, Case{1, glm::pi<float>() / 4, {0.13, 0.015}},
          Case{2, glm::pi<float>() / 4, {0.22, 0.04}}})
        for (const voxels::MipKind kind : kinds) {
            const glm::vec3 place =
                glm::vec3(glm::rotate(glm::mat4(1), c.turn, glm::vec3(0, 1, 0)) * glm::vec4(0.5f, 0, 0, 1));
            const scene::Camera camera = from_above(place, 0.4f);
            const double open = mean(irradiance(divided(0, c.turn), camera, kind, {16, 16}));
            const double leaked = mean(irradiance(divided(c.voxels * voxel, c.turn), camera, kind, {16, 16}));
            ASSERT_GT(open, 0.02);
            const std::string what = fmt::format("{}_voxels_{}_degrees_{}", c.voxels,
                                                 std::lround(glm::degrees(c.turn)), name_of(kind));
            RecordProperty(what, fmt::format("{:.5f}", leaked / open));
            EXPECT_LE(leaked / open, c.most[int(kind == voxels::MipKind::anisotropic)]) << what;
        }
}

/// Irradiance of a floor's point on the axis, at a distance from an evenly bright wall perpendicular to it.
double beside_wall(double distance, double height, double half_length) {
    // Two equal rectangles, from the corner under each (perpendicular; Howell's catalogue, B-4).
    const double slant = std::hypot(distance, height);
    const double factor =
        (std::atan(half_length / distance) - distance / slant * std::atan(half_length / slant)) /
        glm::two_pi<double>();
    return 2 * factor * glm::pi<double>();
}

/// Along a line away from an emitting wall, whose irradiance falls off: how far from the closed form, by how much it
/// rises again, and how sharply it bends. One set of few cones meets the wall, each cone all of a sudden; those of a pattern by and by.
TEST_P(ConesQualityTest, ALitWallFallsOffWithoutBands) {
    scene::Scene scene;
    add(scene, box({-1, -0.04f, -1}, {1, 0, 1}), diffuse(glm::vec3(0)));
    add(scene, box({-1.04f, 0, -1}, {-1, 1.6f, 1}), diffuse(glm::vec3(0), glm::vec3(1)));
    constexpr uint32_t pixels = 128;
    constexpr double width = 1.6;
    const scene::Camera camera = from_above({0, 0, 0}, float(width));
    struct Case {
        voxels::MipKind mips;
        int cones;
        double rms, rise, bend;
    };
    using enum voxels::MipKind;
    for (const Case& c : {Case{isotropic, 9, 0.46, 0.12, 0.09}, Case{anisotropic, 9, 0.11, 0.12, 0.14},
                          Case{anisotropic, 32, 0.04, 0.05, 0.07}}) {
        const scene::ImageF image = irradiance(scene, camera, c.mips, {pixels, pixels}, {.count = c.cones});
        std::vector<double> ratios;
        double squares = 0, bend = 0, rise = 0, lowest = 1e9;
        for (uint32_t x = 0; x < pixels; ++x) {
            const double distance = 1 + width * ((x + 0.5) / pixels - 0.5);
            const double value = double(image.at(x, pixels / 2)[0]), truth = beside_wall(distance, 1.6, 1);
            ratios.push_back(value / truth);
            squares += std::pow(value / truth - 1, 2) / pixels;
            lowest = std::min(lowest, value);
            rise = std::max(rise, value / lowest - 1);
        }
        // Bands are what the ratio to the truth has of bends.
        for (uint32_t x = 1; x + 1 < pixels; ++x)
            bend = std::max(bend, std::abs(ratios[x - 1] - 2 * ratios[x] + ratios[x + 1]));
        const std::string what = fmt::format("{}_{}_cones", name_of(c.mips), c.cones);
        const std::string figures =
            fmt::format("rms {:.4f}, rises by {:.4f}, bends by {:.4f}", std::sqrt(squares), rise, bend);
        RecordProperty(what, figures);
        EXPECT_LT(std::sqrt(squares), c.rms) << what << ": " << figures;
        EXPECT_LT(rise, c.rise) << what << ": " << figures;
        EXPECT_LT(bend, c.bend) << what << ": " << figures;
    }
}

/// A wall of a red and a blue side, in neighbouring voxels, as its mips are seen from either side.
TEST_P(ConesQualityTest, SidesOfAWallMixOnlyInIsotropicMips) {
    scene::Scene scene;
    // Voxels of a metre; the sides lie in the middle of voxels 16 and 17 along x, a pair in each mip.
    const scene::Bounds bounds{{-15.5f, -15.5f, -15.5f}, {15.5f, 15.5f, 15.5f}};
    add(scene, parallelogram({0.5f, -15, -15}, {0, 0, 30}, {0, 30, 0}), diffuse(glm::vec3(0), {1, 0, 0}));
    add(scene, parallelogram({1.5f, -15, 15}, {0, 0, -30}, {0, 30, 0}), diffuse(glm::vec3(0), {0, 0, 1}));
    for (const voxels::MipKind kind : kinds) {
        const Voxelized voxelized =
            voxelize(device(), scene,
                     {.bounds = bounds, .resolution = 32, .range = voxels::Range::fixed, .mips = kind});
        const voxels::LightVolume& light = voxelized.volume.emission();
        const bool isotropic = kind == voxels::MipKind::isotropic;
        ASSERT_FLOAT_EQ(voxelized.grid.voxel_size, 1);
        for (int mip = 1; mip <= 4; ++mip) {
            const VolumeTexels texels = read_volume(device(), isotropic ? light.base : light.directions,
                                                    uint32_t(isotropic ? mip : mip - 1));
            // The red side is seen along +x, the blue along -x.
            for (const bool red : {true, false}) {
                const int direction = isotropic ? 0 : red ? 0 : 1;
                const int at = 16 >> mip, middle = texels.side / 2;
                const glm::vec4 seen = texels.at({direction * texels.side + at, middle, middle});
                const double other = double(red ? seen.b : seen.r), own = double(red ? seen.r : seen.b);
                ASSERT_GT(own, 0) << mip;
                const double share = other / (own + other);
                RecordProperty(fmt::format("{}_mip_{}_{}", name_of(kind), mip, red ? "red" : "blue"),
                               fmt::format("{:.5f}", share));
                if (isotropic) {
                    EXPECT_NEAR(share, 0.5, 0.01) << mip;
                } else {
                    EXPECT_LT(share, 0.05) << mip;
                }
            }
        }
    }
}

}  // namespace
}  // namespace lumo
