// Ambient occlusion against double precision: planes, corners, closed boxes.
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using scene::builtin::parallelogram;

constexpr float very_far = 1e6f;

struct AmbientOcclusionTest : DeviceTest {
    /// One row of the layer, from a camera that looks straight down on y = 0: `width` metres of x about 0, at z = 0.
    std::vector<double> row(scene::Scene scene, float width, uint32_t pixels, const frame::Settings& base) {
        constexpr float height = 1.5f;
        scene.cameras = {{.position = {0, height, 0},
                          .target = {0, 0, 0},
                          .up = {0, 0, -1},
                          .vertical_fov = 2 * std::atan(0.5f * width / height)}};
        frame::Settings settings = base;
        settings.size = {pixels, pixels};
        settings.layers = {frame::Layer::ao};
        const frame::Rendered rendered = must(frame::render(device(), scene, scene.cameras[0], settings));
        const scene::ImageF& image = rendered.layers[0].linear;
        std::vector<double> values;
        for (uint32_t x = 0; x < pixels; ++x) {
            const float* texel = image.at(x, pixels / 2);
            EXPECT_EQ(texel[0], texel[1]);
            EXPECT_EQ(texel[0], texel[2]);
            values.push_back(double(texel[0]));
        }
        return values;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, AmbientOcclusionTest, both_apis, api_name);

frame::Settings settings_of(uint32_t resolution, std::optional<float> radius, voxels::MipKind mips) {
    frame::Settings settings{.ao_radius = radius};
    settings.voxels.resolution = resolution;
    settings.voxels.mips = mips;
    return settings;
}

constexpr voxels::MipKind kinds[] = {voxels::MipKind::isotropic, voxels::MipKind::anisotropic};

/// Without light; nothing is near but itself.
TEST_P(AmbientOcclusionTest, OpenPlaneIsUnoccluded) {
    scene::Scene scene;
    add(scene, parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.5f)));
    // On voxels' faces, so that its voxels reach a whole voxel from it; then, by what lies a voxel lower, amid them.
    for (const auto& [amid, lowest] : {std::pair(false, 0.94), std::pair(true, 0.99)}) {
        if (amid)
            add(scene, triangle({-1, -2.0f / 63, 1}, {-0.99f, -2.0f / 63, 1}, {-1, -2.0f / 63, 0.99f}),
                diffuse(glm::vec3(0.5f)));
        for (const voxels::MipKind kind : kinds) {
            double least = 1, mean = 0;
            for (const double v : row(scene, 1, 16, settings_of(64, very_far, kind))) {
                least = std::min(least, v);
                mean += v / 16;
                EXPECT_LE(v, 1);
            }
            const std::string figures = fmt::format("least {:.4f}, mean {:.4f}", least, mean);
            RecordProperty(fmt::format("plane_{}_{}", amid ? "amid" : "on_faces", int(kind)), figures);
            EXPECT_GT(least, lowest) << "mips " << int(kind) << ": " << figures;
        }
    }
}

TEST_P(AmbientOcclusionTest, ClosedBoxIsOccluded) {
    scene::Scene scene;
    add(scene, scene::builtin::box({-1, 0, -1}, {1, 2, 1}), diffuse(glm::vec3(0.5f)));
    // Seen from within, with the faces turned in.
    for (size_t i = 0; i < scene.indices.size(); i += 3) std::swap(scene.indices[i], scene.indices[i + 1]);
    for (scene::Vertex& v : scene.vertices) v.normal = -v.normal;
    // Isotropic mips hold as little opacity of a wall as of fog of its amount: wide cones pass through both.
    for (const voxels::MipKind kind : kinds) {
        double mean = 0, most = 0;
        for (const double v : row(scene, 1, 16, settings_of(64, very_far, kind))) {
            mean += v / 16;
            most = std::max(most, v);
        }
        const std::string figures = fmt::format("mean {:.4f}, most {:.4f}", mean, most);
        RecordProperty(fmt::format("box_{}", int(kind)), figures);
        EXPECT_LT(mean, kind == voxels::MipKind::isotropic ? 0.52 : 0.01) << figures;
    }
    // What is a radius away occludes by half: all of it is between 1 and 2.25 metres away.
    for (const double v : row(scene, 0.5f, 8, settings_of(64, 0.01f, voxels::MipKind::anisotropic))) {
        EXPECT_GT(v, 0.97);
        EXPECT_LT(v, 0.996);
    }
}

/// Of a floor's point at a distance from a wall of some height and half length: by the midpoint rule over the wall.
double beside_wall(double distance, double height, double half_length, double radius) {
    constexpr int n = 600;
    double occluded = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double y = height * (i + 0.5) / n, z = half_length * (j + 0.5) / n;
            const double squared = distance * distance + y * y + z * z;
            occluded += y * distance / (squared * squared) / (1 + std::sqrt(squared) / radius);
        }
    return 1 - 2 * occluded * height * half_length / (double(n) * n) / glm::pi<double>();
}

TEST_P(AmbientOcclusionTest, FloorAtTheFootOfALongWall) {
    // Long and high: half of the hemisphere is hidden at the wall, by the form factor of perpendicular planes.
    EXPECT_NEAR(beside_wall(0.01, 1, 1, 1e9), 0.5, 0.01);
    EXPECT_NEAR(beside_wall(0.5, 1, 50, 1e9), 0.5 * (1 + 0.5 / std::hypot(0.5, 1.0)), 1e-3);

    scene::Scene scene;
    add(scene, parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.5f)));
    add(scene, parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}), diffuse(glm::vec3(0.5f)));
    constexpr uint32_t pixels = 32;
    for (const voxels::MipKind kind : kinds)
        for (const float radius : {very_far, 0.2f}) {
            frame::Settings settings = settings_of(64, radius, kind);
            settings.cones.count = 18;
            const std::vector<double> values = row(scene, 1.9f, pixels, settings);
            double squares = 0, worst = 0, bias = 0;
            for (uint32_t i = 0; i < pixels; ++i) {
                const double distance = 1 + 1.9 * ((i + 0.5) / pixels - 0.5);
                const double truth = beside_wall(distance, 2, 1, double(radius));
                squares += (values[i] - truth) * (values[i] - truth) / pixels;
                bias += (values[i] - truth) / pixels;
                worst = std::max(worst, std::abs(values[i] - truth));
            }
            const std::string figures = fmt::format("rms {:.4f}, bias {:+.4f}, worst {:.4f}, first {:.4f}",
                                                    std::sqrt(squares), bias, worst, values[0]);
            RecordProperty(fmt::format("wall_{}_{}", int(kind), radius == very_far ? "far" : "near"),
                           figures);
            const bool far = radius == very_far;
            EXPECT_LT(std::sqrt(squares), !far ? 0.02 : 0.06) << figures;
            EXPECT_LT(worst, !far ? 0.05 : 0.08) << figures;
        }
}

/// A tenth of the grid's side when nothing is said; the nearer it is, the less is hidden.
TEST_P(AmbientOcclusionTest, RadiusDecides) {
    scene::Scene scene;
    add(scene, parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.5f)));
    add(scene, parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}), diffuse(glm::vec3(0.5f)));
    const auto with = [&](std::optional<float> radius) {
        return row(scene, 1.9f, 8, settings_of(64, radius, voxels::MipKind::anisotropic));
    };
    const std::vector<double> near = with(0.05f), chosen = with({}), far = with(1.0f);
    const std::vector<double> tenth = with(0.2f * 64 / 63);
    for (size_t i = 0; i < chosen.size(); ++i) {
        EXPECT_NEAR(chosen[i], tenth[i], 1e-5);
        EXPECT_GE(near[i], chosen[i]);
        EXPECT_GE(chosen[i], far[i]);
    }
    EXPECT_GT(near[0], far[0] + 0.1);
}

}  // namespace
}  // namespace lumo
