// Cones in a constant environment, whose irradiance is known: pi times its radiance.
#include "techniques/cones/cones.hpp"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "shaders/frame/layer.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct ConesTest : DeviceTest {
    frame::Rendered render(const scene::Scene& scene, const frame::Settings& settings) {
        return must(frame::render(device(), scene, scene::default_camera(scene), settings));
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, ConesTest, both_apis, api_name);

/// A sphere seen whole, so that normals point everywhere, next to voxels that hold nothing.
TEST_P(ConesTest, EmptyGridGivesTheEnvironmentsIrradiance) {
    scene::Scene scene;
    add(scene, scene::builtin::sphere(1, 32, 16), diffuse(glm::vec3(0.5f)));
    const scene::Camera camera = scene::default_camera(scene);
    constexpr rhi::Extent size{32, 24};
    const scene::GpuScene gpu = must(scene::GpuScene::create(device(), scene, true));
    const scene::GpuScene nothing = must(scene::GpuScene::create(device(), {}, true));
    auto gbuffer = must(gbuffer::GBuffer::create(device(), size, gbuffer::needs_of(gpu.view(), true)));
    constexpr glm::vec3 environment{1, 0.25f, 7};
    const auto copy = compute<shaders::frame::layer>({.distance_layer = false});
    const rhi::Sampler point = nearest_sampler();
    const rhi::Texture target =
        texture({.format = rhi::Format::rgba32_float, .extent = size, .usage = rhi::TextureUsage::storage});

    for (const voxels::MipKind mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic})
        for (const int count : {1, 2, 5, 6, 9, 16, 31, 32}) {
            SCOPED_TRACE(fmt::format("{} cones", count));
            auto volume = must(voxels::Volume::create(device(), {.resolution = 16, .mips = mips}, {}));
            auto irradiance = must(cones::Irradiance::create(
                device(), {.count = count},
                {.environment = true, .anisotropic = mips == voxels::MipKind::anisotropic}, size));
            rhi::Commands commands = device().begin();
            const gbuffer::View seen =
                gbuffer.record(commands, gpu.view(), gbuffer::camera_block(camera, size));
            volume.voxelize(commands, nothing.view(), 0);
            volume.inject(commands, nullptr);
            const auto gathered =
                irradiance.record(commands, seen, {.volume = volume.view(), .environment = environment});
            commands.pass("copy").dispatch(copy,
                                           {.source = {gathered, point},
                                            .layer = target.view<rhi::Dimension::d2>(),
                                            .camera = seen.camera},
                                           {}, rhi::groups_for(size, {8, 8}));
            must(device().wait(device().submit(std::move(commands))));

            const Picture depth = download(device(), gbuffer.depth()), picture = download(device(), target);
            int pixels = 0;
            for (size_t i = 0; i < picture.texels.size(); ++i) {
                const bool drawn = depth.texels[i].x < 1;
                pixels += drawn;
                for (int c = 0; c < 3; ++c) {
                    const float expected = drawn ? glm::pi<float>() * environment[c] : 0;
                    ASSERT_NEAR(picture.texels[i][c], expected, 1e-3f * expected);
                }
            }
            EXPECT_GT(pixels, 100);
        }
}

/// What a convex body in an environment receives, which nothing hides.
struct Furnace {
    uint32_t resolution;
    uint32_t bounces;
    voxels::MipKind mips;
};

TEST_P(ConesTest, WhiteFurnace) {
    const scene::Scene scene = value_of(scene::make_builtin("furnace"));
    using enum voxels::MipKind;
    for (const Furnace& furnace : {Furnace{32, 1, anisotropic}, Furnace{64, 1, anisotropic},
                                   Furnace{64, 1, isotropic}, Furnace{64, 4, anisotropic}}) {
        frame::Settings settings{
            .size = {64, 48},
            .diffuse_materials = true,
            .bounces = furnace.bounces,
            .layers = {frame::Layer::irradiance, frame::Layer::radiance, frame::Layer::depth}};
        settings.voxels = {.resolution = furnace.resolution, .mips = furnace.mips};
        const frame::Rendered rendered = render(scene, settings);
        const scene::ImageF& irradiance = rendered.layers[0].linear;
        const scene::ImageF& radiance = rendered.layers[1].linear;
        const scene::ImageF& depth = rendered.layers[2].linear;
        double least = 1e9, greatest = 0, sum = 0;
        int pixels = 0;
        for (uint32_t y = 0; y < irradiance.height; ++y)
            for (uint32_t x = 0; x < irradiance.width; ++x) {
                if (*depth.at(x, y) == 0) continue;
                for (int c = 0; c < 3; ++c) {
                    const double e = double(irradiance.at(x, y)[c]) / glm::pi<double>();
                    EXPECT_NEAR(e, double(radiance.at(x, y)[c]), 1e-5);
                    least = std::min(least, e);
                    greatest = std::max(greatest, e);
                    sum += e;
                }
                ++pixels;
            }
        ASSERT_GT(pixels, 500);
        const std::string name =
            fmt::format("{} voxels, {} bounces, {}", furnace.resolution, furnace.bounces,
                        furnace.mips == voxels::MipKind::isotropic ? "isotropic" : "anisotropic");
        RecordProperty(fmt::format("voxels_{}_bounces_{}_mips_{}", furnace.resolution, furnace.bounces,
                                   int(furnace.mips)),
                       fmt::format("{:.4f} to {:.4f}, mean {:.4f}", least, greatest, sum / pixels / 3));
        EXPECT_GT(least, 0.98) << name;
        EXPECT_LT(greatest, 1.001) << name;
    }
}

/// What a lone plane in the sun sees of its own light: nothing, in truth. Least well where it lies on the voxels' faces,
/// so that its voxels reach a whole voxel from it; across the grid it is a hundredth.
TEST_P(ConesTest, LitPlaneDoesNotSeeItself) {
    for (const auto& [angle, most] : {std::pair(0.0f, 0.1), std::pair(0.5f, 0.02)}) {
        scene::Scene scene;
        add(scene, scene::builtin::parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(glm::vec3(0.8f)),
            glm::rotate(glm::mat4(1), angle, glm::vec3(1, 0, 0.5f)));
        scene.lights.push_back({.intensity = glm::vec3(glm::pi<float>()), .direction = {0, -1, 0}});
        scene.cameras.push_back({.position = {0, 5, 0}, .target = {0, 0, 0}, .vertical_fov = 0.25f});
        frame::Settings settings{.size = {24, 24},
                                 .diffuse_materials = true,
                                 .layers = {frame::Layer::irradiance, frame::Layer::direct}};
        settings.voxels.resolution = 64;
        const frame::Rendered rendered = render(scene, settings);
        double gathered = 0, leaving = 0;
        for (size_t i = 0; i < rendered.layers[0].linear.values.size(); ++i) {
            gathered += double(rendered.layers[0].linear.values[i]);
            leaving += glm::pi<double>() * double(rendered.layers[1].linear.values[i]);
        }
        ASSERT_GT(leaving, 100);
        RecordProperty(fmt::format("angle_{}", int(10 * angle)), fmt::format("{:.5f}", gathered / leaving));
        EXPECT_LT(gathered, most * leaving) << angle;
    }
}

}  // namespace
}  // namespace lumo
