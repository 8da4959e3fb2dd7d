// What a scene becomes on the GPU: draws, and textures that are there once and only where something shows them.
#include "scene/gpu_scene.hpp"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::scene {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

struct GpuSceneTest : DeviceTest {
    /// Names of the textures in device memory.
    std::vector<std::string> texture_names() {
        std::vector<std::string> names;
        for (const rhi::MemoryEntry& entry : device().memory())
            if (entry.name.starts_with("material.")) names.push_back(entry.name);
        return names;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, GpuSceneTest, both_apis, api_name);

const glm::mat4 mirror = glm::scale(glm::mat4(1), {-1, 1, 1});
glm::mat4 moved(float x) { return glm::translate(glm::mat4(1), {x, 0, 0}); }

TEST_P(GpuSceneTest, InstancesOfOneMeshAreOneDrawPerWinding) {
    Scene scene;
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, {}, moved(1));
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, {}, moved(-5));
    scene.instances.push_back({0, mirror});
    scene.instances.push_back({0, moved(3)});
    const GpuScene gpu = testing_support::must(GpuScene::create(device(), scene));
    const GeometryView view = gpu.view();
    ASSERT_EQ(view.draws.size(), 3u);
    EXPECT_EQ(view.draws[0].instances, 2u);
    EXPECT_FALSE(view.draws[0].mirrored);
    EXPECT_EQ(view.draws[0].center, glm::vec3(2, 0, 0));
    EXPECT_EQ(view.draws[1].instances, 1u);
    EXPECT_TRUE(view.draws[1].mirrored);
    EXPECT_EQ(view.draws[1].first_instance, view.draws[0].first_instance + 2);
    EXPECT_EQ(view.draws[2].material, 1u);
    EXPECT_EQ(view.draws[2].first_index, 6u);
    EXPECT_EQ(view.bounds.min, glm::vec3(-6, -1, 0));
    EXPECT_EQ(view.bounds.max, glm::vec3(4, 1, 0));
}

TEST_P(GpuSceneTest, DrawsAreSortedAndBlendedOnesAreSingle) {
    Scene scene;
    for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask, AlphaMode::opaque}) {
        Material material{.alpha_mode = mode};
        add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material, moved(2));
        scene.instances.push_back({uint32_t(scene.meshes.size() - 1), moved(-2)});
    }
    const GpuScene gpu = testing_support::must(GpuScene::create(device(), scene));
    std::vector<AlphaMode> modes;
    std::vector<uint32_t> instances;
    std::vector<float> centers;
    for (const DrawView& draw : gpu.view().draws) {
        modes.push_back(draw.alpha_mode);
        instances.push_back(draw.instances);
        centers.push_back(draw.center.x);
    }
    EXPECT_THAT(modes, ElementsAre(AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend, AlphaMode::blend));
    EXPECT_THAT(instances, ElementsAre(2, 2, 1, 1));
    EXPECT_THAT(centers, ElementsAre(0, 0, 2, -2));
}

TEST_P(GpuSceneTest, ImagesAreThereOncePerEncodingAndOnlyWhereDrawn) {
    Scene scene;
    const TextureSlot shared = add_texel(scene, {200, 100, 50, 255});
    const TextureSlot undrawn = add_texel(scene, {1, 2, 3, 255});
    const TextureSlot dark = add_texel(scene, {9, 9, 9, 255});
    Material material;
    material.base_color_texture = shared;
    material.metallic_roughness_texture = shared;
    material.occlusion_texture = shared;
    material.emission_texture = dark;  // of no emission
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
    Material other;
    other.base_color_texture = undrawn;
    scene.materials.push_back(other);
    {
        const GpuScene gpu = testing_support::must(GpuScene::create(device(), scene));
        EXPECT_THAT(texture_names(), UnorderedElementsAre("material.image0.color", "material.image0.data",
                                                          "material.neutral", "material.neutral"));
        EXPECT_EQ(gpu.view().textures.size(), 3u);
    }
    {
        const GpuScene gpu = testing_support::must(GpuScene::create(device(), scene, true));
        EXPECT_THAT(texture_names(),
                    UnorderedElementsAre("material.image0.color", "material.neutral", "material.neutral"));
        EXPECT_FALSE(gpu.view().draws[0].normal_mapped);
    }
    EXPECT_THAT(texture_names(), IsEmpty());
}

TEST_P(GpuSceneTest, AnEmptySceneIsAllBackground) {
    const RenderedTargets targets =
        render(device(), Scene{}, Camera{},
               {.size = {8, 8}, .sun = Sun{{0, 1, 0}, glm::vec3(1)}, .environment = {1, 2, 3}});
    for (const glm::vec4& texel : targets.radiance.texels) EXPECT_EQ(texel, glm::vec4(1, 2, 3, 1));
}

TEST_P(GpuSceneTest, ViewsOutliveMoves) {
    Scene scene;
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, {});
    GpuScene first = testing_support::must(GpuScene::create(device(), scene));
    const GeometryView view = first.view();
    const GpuScene second = std::move(first);
    EXPECT_EQ(view.draws.data(), second.view().draws.data());
    EXPECT_EQ(view.vertices, second.view().vertices);
}

}  // namespace
}  // namespace lumo::scene
