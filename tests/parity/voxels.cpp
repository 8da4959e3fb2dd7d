// Voxels on OpenGL and Vulkan.
#include "tests/support/voxels.hpp"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "tests/support/both_apis.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct VoxelParityTest : BothApisTest {
    template <class Compare>
    void compare_mips(const rhi::Texture& a, const rhi::Texture& b, const Compare& compare) {
        ASSERT_EQ(a.desc().mips, b.desc().mips);
        for (uint32_t mip = 0; mip < a.desc().mips; ++mip) {
            SCOPED_TRACE(fmt::format("{}, mip {}", a.desc().name, mip));
            compare(read_volume(gl(), a, mip), read_volume(vulkan(), b, mip));
        }
    }
    template <class Compare>
    void compare_volumes(const voxels::LightVolume& a, const voxels::LightVolume& b, const Compare& compare) {
        compare_mips(a.base, b.base, compare);
        if (a.directions) compare_mips(a.directions, b.directions, compare);
    }
};

void expect_equal_bits(const VolumeTexels& a, const VolumeTexels& b) {
    ASSERT_EQ(a.bytes.size(), b.bytes.size());
    size_t different = 0;
    for (size_t i = 0; i < a.bytes.size(); ++i) different += a.bytes[i] != b.bytes[i];
    EXPECT_EQ(different, 0u) << "of " << a.bytes.size() << " bytes";
}

Sun sun_of(const scene::Scene& scene) {
    for (const scene::Light& light : scene.lights)
        if (light.kind == scene::LightKind::directional)
            return {-glm::normalize(light.direction), light.intensity};
    return {glm::normalize(glm::vec3(0.4f, 1, 0.3f)), {3, 2.5f, 2}};
}

/// Turned bodies of three materials, one of them an emitter: nothing lies along the grid.
scene::Scene turned_scene() {
    scene::Scene scene;
    add(scene, scene::builtin::box({-2, -0.2f, -2}, {2, 0, 2}), diffuse({0.7f, 0.6f, 0.5f}),
        glm::rotate(glm::mat4(1), 0.1f, glm::normalize(glm::vec3(1, 0, 1))));
    add(scene, scene::builtin::sphere(0.6f, 40, 20), diffuse({0.1f, 0.8f, 0.3f}),
        scene::builtin::translation({-0.7f, 0.9f, 0.2f}));
    add(scene, scene::builtin::box(glm::vec3(-0.4f), glm::vec3(0.4f)),
        diffuse({0.2f, 0.2f, 0.2f}, {5, 3, 0.5f}),
        glm::rotate(scene::builtin::translation({0.9f, 1, -0.3f}), 0.8f, glm::normalize(glm::vec3(1, 2, 3))));
    return scene;
}

TEST_F(VoxelParityTest, UntexturedScenesAreEqualToTheBit) {
    for (const std::string name : {"cornell", "furnace", "area-light", "turned", "atrium"}) {
        SCOPED_TRACE(name);
        const scene::Scene scene =
            name == "turned" ? turned_scene() : without_textures(value_of(scene::make_builtin(name)));
        for (const voxels::MipKind mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic}) {
            const VoxelOptions options{
                .resolution = 64,
                .sun = sun_of(scene),
                .normals = true,
                .range = highest_emission(scene) > 0 ? voxels::Range::fixed : voxels::Range::ldr,
                .mips = mips};
            const Voxelized a = voxelize(gl(), scene, options), b = voxelize(vulkan(), scene, options);
            compare_mips(a.volume.albedo(), b.volume.albedo(), expect_equal_bits);
            compare_mips(a.volume.area(), b.volume.area(), expect_equal_bits);
            compare_mips(a.volume.normal(), b.volume.normal(), expect_equal_bits);
            compare_mips(a.volume.direct_flux(), b.volume.direct_flux(), expect_equal_bits);
            compare_volumes(a.volume.radiance(), b.volume.radiance(), expect_equal_bits);
            if (highest_emission(scene) > 0)
                compare_volumes(a.volume.emission(), b.volume.emission(), expect_equal_bits);
            if (mips == voxels::MipKind::isotropic) {
                const VoxelMap<bool> occupied = occupancy_of(read_volume(gl(), a.volume.albedo()));
                EXPECT_GT(std::count(occupied.values.begin(), occupied.values.end(), true), 1000);
            }
        }
    }
}

TEST_F(VoxelParityTest, LightOfSeveralLightsIsEqualToTheBit) {
    const scene::Scene scene = turned_scene();
    const VoxelOptions options{
        .resolution = 64,
        .sun = Sun{},
        .lights = {{.kind = scene::LightKind::point, .intensity = {3, 2, 1}, .position = {0.1f, 1.7f, 0.4f}},
                   {.kind = scene::LightKind::spot,
                    .intensity = {9, 0.5f, 4},
                    .position = {-1, 2, 1},
                    .direction = glm::normalize(glm::vec3(0.4f, -1, -0.5f))}},
        .range = voxels::Range::fixed};
    const Voxelized a = voxelize(gl(), scene, options), b = voxelize(vulkan(), scene, options);
    compare_mips(a.volume.direct_flux(), b.volume.direct_flux(), expect_equal_bits);
    compare_volumes(a.volume.radiance(), b.volume.radiance(), expect_equal_bits);
}

TEST_F(VoxelParityTest, TexturedAtriumIsWithinOneStep) {
    const scene::Scene scene = value_of(scene::make_builtin("atrium"));
    const VoxelOptions options{.resolution = 64, .sun = sun_of(scene), .normals = true};
    const Voxelized a = voxelize(gl(), scene, options), b = voxelize(vulkan(), scene, options);
    // Occupancy, area and light come from geometry alone.
    compare_mips(a.volume.area(), b.volume.area(), expect_equal_bits);
    compare_mips(a.volume.normal(), b.volume.normal(), expect_equal_bits);
    compare_mips(a.volume.direct_flux(), b.volume.direct_flux(), expect_equal_bits);
    const auto one_step = [](const VolumeTexels& gl, const VolumeTexels& vulkan) {
        size_t occupied = 0, different = 0;
        float worst = 0;
        for (size_t i = 0; i < gl.texels.size(); ++i) {
            const glm::vec4 d = glm::abs(gl.texels[i] - vulkan.texels[i]);
            const float largest = std::max({d.r, d.g, d.b, d.a});
            occupied += gl.texels[i].a > 0;
            different += largest > 0;
            worst = std::max(worst, largest);
        }
        EXPECT_LE(worst, 1.001f / 255);
        EXPECT_LE(double(different), 1e-4 * double(occupied)) << "of " << occupied << " occupied";
    };
    compare_mips(a.volume.albedo(), b.volume.albedo(), one_step);
    compare_mips(a.volume.radiance().base, b.volume.radiance().base, one_step);
}

}  // namespace
}  // namespace lumo
