// An octree read back, by a second reading of what shaders/voxels/octree.glsl says of its layout.
#pragma once

#include <bit>
#include <cstring>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "rhi/rhi.hpp"
#include "techniques/voxels/octree.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::testing_support {

/// Place of a voxel's bit in an occupancy volume of words over 4 x 4 x 2, in Morton order.
struct BitPlace {
    size_t word;
    uint32_t bit;
};
inline BitPlace bit_place(glm::ivec3 v, glm::ivec3 words) {
    const glm::ivec3 w(v.x / 4, v.y / 4, v.z / 2);
    const int bit = v.x % 2 + 2 * (v.y % 2) + 4 * (v.z % 2) + 8 * (v.x / 2 % 2) + 16 * (v.y / 2 % 2);
    return {(size_t(w.z) * size_t(words.y) + size_t(w.y)) * size_t(words.x) + size_t(w.x), uint32_t(bit)};
}

/// The bricks of one light volume, or the nodes alone.
class OctreeTexels {
  public:
    OctreeTexels(rhi::Device& device, const voxels::Octree& octree, const voxels::LightVolume& light,
                 int directions)
        : levels_(int(octree.levels())), directions_(directions) {
        for (int level = 0; level < levels_ - 2; ++level) {
            const auto bytes = value_of(device.download(
                octree.node_texture(), rhi::whole_mip(octree.node_texture().desc(), uint32_t(level))));
            words_.emplace_back(bytes.size() / sizeof(glm::uvec2));
            std::memcpy(words_.back().data(), bytes.data(), bytes.size());
        }
        for (const rhi::Texture* texture : {&light.base, &light.directions}) {
            pools_.push_back({texture->desc().extent,
                              value_of(device.download(*texture, rhi::whole_mip(texture->desc())))});
            Pool& pool = pools_.back();
            pool.stride =
                pool.bytes.size() / (size_t(pool.extent.width) * pool.extent.height * pool.extent.depth);
        }
    }

    int levels() const { return levels_; }
    /// Voxels a side.
    int side(int level) const { return 1 << (levels_ - level); }
    size_t stride() const { return pools_[0].stride; }

    /// Of a node, by its place among its level's nodes.
    std::optional<int> slot(glm::ivec3 node, int level) const {
        const int nodes = side(level) / 4;
        if (nodes <= 1) return levels_ - level;
        const glm::ivec3 words(std::max(nodes / 4, 1), std::max(nodes / 4, 1), std::max(nodes / 2, 1));
        const BitPlace place = bit_place(node, words);
        const glm::uvec2 word = words_[size_t(level)][place.word];
        if (!(word.x >> place.bit & 1)) return {};
        return int(word.y) + std::popcount(word.x & ((1u << place.bit) - 1));
    }

    /// The bytes of a brick's texel, 0 to 4 along each axis.
    const std::byte* texel(int slot, int level, glm::ivec3 texel, int direction) const {
        const Pool& pool = pools_[level > 0];
        const int row = side(0) / (level > 0 ? 16 : 8);
        const glm::ivec3 at = 5 * glm::ivec3(slot % row + (level > 0 ? direction * row : 0), slot / row % row,
                                             slot / (row * row)) +
                              texel;
        return pool.bytes.data() +
               ((size_t(at.z) * pool.extent.height + size_t(at.y)) * pool.extent.width + size_t(at.x)) *
                   pool.stride;
    }
    int directions() const { return directions_; }

  private:
    struct Pool {
        rhi::Extent extent;
        std::vector<std::byte> bytes;
        size_t stride = 0;
    };
    int levels_;
    int directions_;
    std::vector<std::vector<glm::uvec2>> words_;
    std::vector<Pool> pools_;
};

/// How the octree's values differ from those of a dense volume of the same light.
struct OctreeDifference {
    size_t nodes = 0;     ///< that exist
    size_t compared = 0;  ///< texels of bricks
    size_t unequal = 0;   ///< … that are not the volume's
    size_t missing = 0;   ///< voxels that are not black in the volume, and have no node
};
inline OctreeDifference compare_octree(rhi::Device& device, const OctreeTexels& octree,
                                       const voxels::LightVolume& dense) {
    OctreeDifference difference;
    const bool directional = octree.directions() > 1;
    for (int level = 0; level <= octree.levels(); ++level) {
        const rhi::Texture& texture = directional && level > 0 ? dense.directions : dense.base;
        const uint32_t mip = uint32_t(directional && level > 0 ? level - 1 : level);
        const auto bytes = value_of(device.download(texture, rhi::whole_mip(texture.desc(), mip)));
        const int side = octree.side(level), directions = directional && level > 0 ? 6 : 1;
        const size_t stride = octree.stride();
        const std::vector<std::byte> zero(stride);
        const auto stored = [&](glm::ivec3 v, int direction) {
            const size_t x = size_t(direction) * size_t(side) + size_t(v.x);
            return bytes.data() +
                   ((size_t(v.z) * size_t(side) + size_t(v.y)) * size_t(side * directions) + x) * stride;
        };
        const int nodes = std::max(side / 4, 1);
        for (int z = 0; z < nodes; ++z)
            for (int y = 0; y < nodes; ++y)
                for (int x = 0; x < nodes; ++x) {
                    const std::optional<int> slot = octree.slot({x, y, z}, level);
                    difference.nodes += slot.has_value();
                    for (int i = 0; i < 125 * directions; ++i) {
                        const glm::ivec3 t(i % 5, i / 5 % 5, i / 25 % 5);
                        const int direction = i / 125;
                        const glm::ivec3 v = glm::ivec3(x, y, z) * 4 + t;
                        const bool inside = v.x < side && v.y < side && v.z < side;
                        const std::byte* expected = inside ? stored(v, direction) : zero.data();
                        const bool black = std::memcmp(expected, zero.data(), stride) == 0;
                        if (!slot) {
                            difference.missing += !black;
                        } else {
                            ++difference.compared;
                            difference.unequal +=
                                std::memcmp(octree.texel(*slot, level, t, direction), expected, stride) != 0;
                        }
                    }
                }
    }
    return difference;
}

}  // namespace lumo::testing_support
