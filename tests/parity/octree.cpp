// The octree on OpenGL and Vulkan.
#include "tests/support/octree.hpp"

#include <gtest/gtest.h>

#include "scene/builtin/builtin.hpp"
#include "tests/support/both_apis.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

using OctreeParityTest = BothApisTest;

TEST_F(OctreeParityTest, UntexturedScenesAreEqualToTheBit) {
    for (const std::string name : {"cornell", "atrium"}) {
        const scene::Scene scene = without_textures(value_of(scene::make_builtin(name)));
        for (const voxels::MipKind mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic}) {
            SCOPED_TRACE(name);
            const VoxelOptions options{.resolution = 64,
                                       .sun = Sun{glm::normalize(glm::vec3(0.4f, 1, 0.3f)), {3, 2.5f, 2}},
                                       .normals = true,
                                       .mips = mips,
                                       .storage = voxels::Storage::octree};
            const Voxelized a = voxelize(gl(), scene, options), b = voxelize(vulkan(), scene, options);
            const int directions = mips == voxels::MipKind::isotropic ? 1 : 6;
            const OctreeTexels from_gl(gl(), *a.volume.octree(), a.volume.radiance(), directions);
            const OctreeTexels from_vulkan(vulkan(), *b.volume.octree(), b.volume.radiance(), directions);
            size_t nodes = 0, differing_slots = 0, differing_texels = 0, lit = 0;
            for (int level = 0; level <= from_gl.levels(); ++level) {
                const int side = std::max(from_gl.side(level) / 4, 1);
                for (int i = 0; i < side * side * side; ++i) {
                    const glm::ivec3 node(i % side, i / side % side, i / side / side);
                    const auto slot = from_gl.slot(node, level);
                    differing_slots += slot != from_vulkan.slot(node, level);
                    if (!slot || slot != from_vulkan.slot(node, level)) continue;
                    ++nodes;
                    for (int t = 0; t < 125 * (level > 0 ? directions : 1); ++t) {
                        const glm::ivec3 texel(t % 5, t / 5 % 5, t / 25 % 5);
                        const std::byte* left = from_gl.texel(*slot, level, texel, t / 125);
                        const std::byte* right = from_vulkan.texel(*slot, level, texel, t / 125);
                        differing_texels += std::memcmp(left, right, from_gl.stride()) != 0;
                        lit += left[0] != std::byte{0};
                    }
                }
            }
            EXPECT_EQ(differing_slots, 0u);
            EXPECT_EQ(differing_texels, 0u);
            EXPECT_GT(nodes, 500u);
            EXPECT_GT(lit, 1000u);
        }
    }
}

}  // namespace
}  // namespace lumo
