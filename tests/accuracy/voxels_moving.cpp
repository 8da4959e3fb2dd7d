// Objects that move: what is voxelized of them alone is what voxelizing everything gives.
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct MovingTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, MovingTest, both_apis, api_name);

/// A room with a ball and a glowing box at a place, as draws 0 to 2 in some order.
scene::Scene at(glm::vec3 ball, float turn) {
    scene::Scene scene;
    add(scene, scene::builtin::box(glm::vec3(-2), glm::vec3(2)), diffuse({0.6f, 0.5f, 0.4f}));
    add(scene, scene::builtin::sphere(0.5f, 32, 16), diffuse({0.2f, 0.7f, 0.3f}),
        scene::builtin::translation(ball));
    add(scene, scene::builtin::box(glm::vec3(-0.3f), glm::vec3(0.3f)),
        diffuse({0.5f, 0.5f, 0.5f}, {7, 3, 0.2f}),
        glm::rotate(scene::builtin::translation({0.9f, 0.5f, -0.6f}), turn,
                    glm::normalize(glm::vec3(1, 2, 1))));
    return scene;
}

TEST_P(MovingTest, MovedIsAsFromScratch) {
    using voxels::Range;
    const std::array places{at({-0.8f, 0.2f, 0.4f}, 0), at({-0.5f, -0.6f, 0.7f}, 0.9f),
                            at({-0.8f, 0.2f, 0.4f}, 2)};
    const std::array<uint32_t, 2> moved{1, 2};
    for (const Range range : {Range::ldr, Range::fixed})
        for (const auto voxelizer : {voxels::VoxelizerKind::compute, voxels::VoxelizerKind::raster}) {
            SCOPED_TRACE(std::string(to_string(range)) + " " + std::string(to_string(voxelizer)));
            std::vector<scene::GpuScene> scenes;
            for (const scene::Scene& scene : places)
                scenes.push_back(value_of(scene::GpuScene::create(device(), scene, true)));
            const scene::GeometryView first = scenes[0].view();
            ASSERT_EQ(first.draws.size(), 3u);
            const voxels::Needs needs{.emission = true,
                                      .normals = true,
                                      .triangles = voxels::count_triangles(first),
                                      .draws = uint32_t(first.draws.size())};
            const voxels::Settings settings{
                .resolution = 32, .voxelizer = voxelizer, .range = range, .moving = true};
            voxels::Volume volume = value_of(voxels::Volume::create(device(), settings, needs));
            rhi::Commands commands = device().begin();
            volume.voxelize(commands, first, 7);
            for (size_t i = 1; i < places.size(); ++i)
                volume.move(commands, scenes[i - 1].view(), scenes[i].view(), moved, 7);
            volume.inject(commands, nullptr);
            value_of(device().wait(device().submit(std::move(commands))));

            const Voxelized fresh =
                voxelize(device(), places.back(),
                         {.resolution = 32, .normals = true, .range = range, .voxelizer = voxelizer});
            const auto expect_equal = [&](const rhi::Texture& a, const rhi::Texture& b) {
                for (uint32_t mip = 0; mip < a.desc().mips; ++mip) {
                    const auto bytes = value_of(device().download(a, rhi::whole_mip(a.desc(), mip)));
                    EXPECT_EQ(bytes, value_of(device().download(b, rhi::whole_mip(b.desc(), mip))))
                        << a.desc().name;
                }
            };
            expect_equal(volume.albedo(), fresh.volume.albedo());
            expect_equal(volume.area(), fresh.volume.area());
            expect_equal(volume.normal(), fresh.volume.normal());
            expect_equal(volume.emission().base, fresh.volume.emission().base);
            expect_equal(volume.emission().directions, fresh.volume.emission().directions);
        }
}

/// What leaves the bounds changes the grid, and then everything is voxelized.
TEST_P(MovingTest, AChangedGridIsFilledAnew) {
    const scene::Scene before = at({-0.8f, 0.2f, 0.4f}, 0), after = at({-2.5f, 0.2f, 0.4f}, 0);
    const scene::GpuScene gpu_before = value_of(scene::GpuScene::create(device(), before, true)),
                          gpu_after = value_of(scene::GpuScene::create(device(), after, true));
    const scene::GeometryView view = gpu_before.view();
    voxels::Volume volume = value_of(voxels::Volume::create(device(), {.resolution = 32, .moving = true},
                                                            {.emission = true,
                                                             .triangles = voxels::count_triangles(view),
                                                             .draws = uint32_t(view.draws.size())}));
    rhi::Commands commands = device().begin();
    volume.voxelize(commands, view, 7);
    volume.move(commands, view, gpu_after.view(), std::array<uint32_t, 1>{1}, 7);
    volume.inject(commands, nullptr);
    value_of(device().wait(device().submit(std::move(commands))));
    const Voxelized fresh = voxelize(device(), after, {.resolution = 32});
    EXPECT_EQ(
        value_of(device().download(volume.albedo(), rhi::whole_mip(volume.albedo().desc()))),
        value_of(device().download(fresh.volume.albedo(), rhi::whole_mip(fresh.volume.albedo().desc()))));
}

}  // namespace
}  // namespace lumo
