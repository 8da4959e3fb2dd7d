// Scenes in an octree and in a dense volume: the same surfaces, the same light at every level, the same pictures.
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/octree.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using voxels::MipKind;
using voxels::Storage;

struct OctreeSceneTest : DeviceTest {
    frame::Rendered render(const scene::Scene& scene, const frame::Settings& settings) {
        return must(frame::render(device(), scene, scene::default_camera(scene), settings));
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, OctreeSceneTest, both_apis, api_name);

struct SceneCase {
    std::string name;
    MipKind mips;
    voxels::Range range;
};

/// Surfaces of the voxels that an octree lists, and of the same voxels in a volume.
size_t unequal_cells(const std::vector<uint32_t>& list, const VolumeTexels& cells, const VolumeTexels& grid) {
    size_t unequal = 0;
    for (int i = 0; i < int(list.size()); ++i) {
        const uint32_t v = list[size_t(i)];
        const glm::vec4 cell = cells.at({i & 127, i >> 7 & 127, i >> 14});
        unequal += cell != grid.at({v & 1023, v >> 10 & 1023, v >> 20});
    }
    return unequal;
}

TEST_P(OctreeSceneTest, SurfacesAndLightAreTheVolumes) {
    for (const auto& [name, mips, range] :
         {SceneCase{"atrium", MipKind::isotropic, voxels::Range::ldr},
          SceneCase{"cornell", MipKind::anisotropic, voxels::Range::fixed}}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = value_of(scene::make_builtin(name));
        VoxelOptions options{.resolution = 32,
                             .sun = Sun{glm::normalize(glm::vec3(0.4f, 1, 0.3f)), {3, 2.5f, 2}},
                             .shadow_resolution = 256,
                             .normals = true,
                             .range = range,
                             .mips = mips};
        const Voxelized dense = voxelize(device(), scene, options);
        options.storage = Storage::octree;
        const Voxelized sparse = voxelize(device(), scene, options);
        ASSERT_NE(sparse.volume.octree(), nullptr);

        const auto list = values_of<uint32_t>(must(device().download(sparse.volume.voxel_list())));
        const VolumeTexels albedo = read_volume(device(), dense.volume.albedo());
        const VoxelMap<bool> occupied = occupancy_of(albedo);
        EXPECT_EQ(list.size(), size_t(std::count(occupied.values.begin(), occupied.values.end(), true)));
        EXPECT_EQ(unequal_cells(list, read_volume(device(), sparse.volume.albedo()), albedo), 0u);
        EXPECT_EQ(unequal_cells(list, read_volume(device(), sparse.volume.area()),
                                read_volume(device(), dense.volume.area())),
                  0u);
        EXPECT_EQ(unequal_cells(list, read_volume(device(), sparse.volume.normal()),
                                read_volume(device(), dense.volume.normal())),
                  0u);
        EXPECT_EQ(unequal_cells(list, read_volume(device(), sparse.volume.direct_flux()),
                                read_volume(device(), dense.volume.direct_flux())),
                  0u);

        const auto expect_same = [&](const voxels::LightVolume& light, const voxels::LightVolume& expected) {
            const OctreeTexels texels(device(), *sparse.volume.octree(), light,
                                      mips == MipKind::isotropic ? 1 : 6);
            const OctreeDifference difference = compare_octree(device(), texels, expected);
            EXPECT_EQ(difference.unequal, 0u) << "of " << difference.compared;
            EXPECT_EQ(difference.missing, 0u);
            EXPECT_GT(difference.nodes, 50u);
        };
        expect_same(sparse.volume.radiance(), dense.volume.radiance());
        if (highest_emission(scene) > 0) expect_same(sparse.volume.emission(), dense.volume.emission());
    }
}

/// A box with a lamp, behind a pane of coloured glass.
scene::Scene behind_glass() {
    scene::Scene scene = value_of(scene::make_builtin("cornell"));
    scene::Material glass = diffuse({0.2f, 0.9f, 0.4f});
    glass.base_color.a = 0.4f;
    glass.alpha_mode = scene::AlphaMode::blend;
    const scene::Bounds bounds = scene::world_bounds(scene);
    const glm::vec3 center = (bounds.min + bounds.max) * 0.5f, half = (bounds.max - bounds.min) * 0.5f;
    add_quad(scene, center + glm::vec3(0, 0, 0.6f * half.z), {0.5f * half.x, 0, 0}, {0, 0.5f * half.y, 0},
             glass);
    return scene;
}

/// Root of the mean squared difference over the mean.
double relative_rmse(const scene::ImageF& a, const scene::ImageF& reference) {
    double squares = 0, sum = 0;
    for (size_t i = 0; i < a.values.size(); ++i) {
        squares += std::pow(double(a.values[i]) - double(reference.values[i]), 2);
        sum += double(reference.values[i]);
    }
    return std::sqrt(squares * double(a.values.size())) / std::max(sum, 1e-12);
}

TEST_P(OctreeSceneTest, PicturesAreTheVolumes) {
    struct Case {
        std::string name;
        MipKind mips;
        uint32_t bounces;
    };
    for (const auto& [name, mips, bounces] :
         {Case{"glass", MipKind::isotropic, 2}, Case{"atrium", MipKind::anisotropic, 1}}) {
        const scene::Scene scene = name == "glass" ? behind_glass() : value_of(scene::make_builtin(name));
        frame::Settings settings{
            .size = {48, 36},
            .bounces = bounces,
            .layers = {frame::Layer::irradiance, frame::Layer::radiance, frame::Layer::voxels}};
        // Enough voxels for several layers of the list of cells.
        settings.voxels = {.resolution = 64, .mips = mips};
        const frame::Rendered dense = render(scene, settings);
        settings.voxels.storage = Storage::octree;
        const frame::Rendered sparse = render(scene, settings);
        for (size_t i = 0; i < settings.layers.size(); ++i) {
            const std::string layer(to_string(settings.layers[i]));
            SCOPED_TRACE(fmt::format("{}, {}, {} bounces", layer, name, bounces));
            double brightest = 0;
            for (const float value : dense.layers[i].linear.values)
                brightest = std::max(brightest, double(value));
            EXPECT_GT(brightest, 0.01);
            const double error = relative_rmse(sparse.layers[i].linear, dense.layers[i].linear);
            RecordProperty(fmt::format("{}_{}_{}", name, layer, bounces), fmt::format("{:.2e}", error));
            EXPECT_LT(error, 0.02);
        }
    }
}

TEST_P(OctreeSceneTest, NothingToHold) {
    scene::Scene empty;
    empty.environment_radiance = {0.25f, 0.5f, 1};
    frame::Settings settings{.size = {16, 16},
                             .layers = {frame::Layer::radiance, frame::Layer::irradiance,
                                        frame::Layer::specular, frame::Layer::voxels},
                             .plan = frame::PlanMode::full};
    for (const Storage storage : {Storage::dense, Storage::octree}) {
        settings.voxels = {.resolution = 16, .storage = storage};
        for (const frame::LayerImage& layer : render(empty, settings).layers) {
            const bool sees_environment = layer.layer == frame::Layer::radiance;
            for (size_t i = 0; i < layer.linear.values.size(); ++i)
                ASSERT_EQ(layer.linear.values[i],
                          sees_environment ? empty.environment_radiance[int(i % 3)] : 0)
                    << to_string(layer.layer);
        }
    }

    // One voxel, and what is thinner than any.
    scene::Scene speck;
    add(speck, triangle({0, 0, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}), diffuse(glm::vec3(0.5f), glm::vec3(2)));
    add(speck, triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), diffuse(glm::vec3(0.5f)));
    VoxelOptions options{.resolution = 16, .sun = Sun{}, .shadow_resolution = 64};
    const Voxelized dense = voxelize(device(), speck, options);
    options.storage = Storage::octree;
    const Voxelized sparse = voxelize(device(), speck, options);
    const OctreeTexels texels(device(), *sparse.volume.octree(), sparse.volume.radiance(), 6);
    EXPECT_EQ(compare_octree(device(), texels, dense.volume.radiance()).unequal, 0u);
}

}  // namespace
}  // namespace lumo
