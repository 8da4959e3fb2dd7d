// Which voxels hold something, level by level, and which nodes an octree over them has.
#pragma once

#include <cstdint>
#include <vector>

#include "rhi/rhi.hpp"
#include "shaders/voxels/mark.hpp"
#include "shaders/voxels/mark_large.hpp"
#include "shaders/voxels/mark_small.hpp"
#include "shaders/voxels/octree_coarsen.hpp"
#include "shaders/voxels/octree_nodes.hpp"
#include "shaders/voxels/octree_scan.hpp"
#include "techniques/voxels/voxelizer.hpp"

namespace lumo::voxels {

/// Where voxelizers set bits: Occupancy::marks. `fragments`: a uint32_t that their number is added to, if asked for.
struct Marks {
    using Raster = shaders::voxels::mark;
    using Small = shaders::voxels::mark_small;
    using Large = shaders::voxels::mark_large;

    Raster::Bindings raster(const DrawSources& draw) const;
    template <class P>
    typename P::Bindings compute(const DrawSources& draw, const LargeTriangles& large) const {
        return {.vertices = draw.vertices,
                .indices = draw.indices,
                .instances = draw.instances,
                .material = draw.material,
                .base_color_texture = draw.base_color_texture,
                .marks = marks,
                .large_arguments = large.arguments,
                .large_list = large.list,
                .fragments = fragments};
    }

    rhi::View<rhi::Dimension::d3> marks;
    rhi::StorageBuffer fragments;
};
/// Errors: those of the device.
Result<Voxelizer<Marks>> create_marker(rhi::Device& device, VoxelizerKind kind, const VoxelizerNeeds& needs,
                                       bool count_fragments = false);

/// How large an octree is.
struct OctreeSize {
    std::vector<uint32_t> nodes;  ///< by level, from the finest; empty: nothing was counted
    uint32_t voxels = 0;          ///< occupied ones of level 0

    uint32_t fine_nodes() const { return nodes.empty() ? 0 : nodes.front(); }
    uint32_t coarse_nodes() const;  ///< of all levels but the finest
};

/// Bits that a voxelizer sets, and what follows from them. The layout is described in shaders/voxels/octree.glsl.
class Occupancy {
  public:
    /// For `resolution` voxels a side, a power of two from 16 up. Errors: those of the device.
    static Result<Occupancy> create(rhi::Device& device, uint32_t resolution);

    /// Empties the finest level, which a voxelizer then marks (shaders/voxels/occupancy.glsl).
    void clear(rhi::Commands& commands);
    rhi::View<rhi::Dimension::d3> marks() const { return bits_.mip<rhi::Dimension::d3>(0); }
    /// From the marks: the coarser levels, the nodes, and their prefix sums.
    void record(rhi::Commands& commands);

    /// Of what was last recorded; waits for it. Errors: those of the device.
    Result<OctreeSize> size(rhi::Device& device) const;

    /// log2 of the resolution.
    uint32_t levels() const { return levels_; }
    /// Levels with more than one node.
    uint32_t node_levels() const { return levels_ - 2; }
    /// Words of nodes of one of these levels.
    rhi::Extent words(uint32_t level) const;
    /// Place of the level's words in the buffers: coarse levels come first.
    uint32_t first_word(uint32_t level) const;

    const rhi::Texture& bits() const { return bits_; }  ///< r32_uint, a mip a level down to 2 voxels a side
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> sampled_bits() const;
    rhi::SamplerHandle point_sampler() const { return point_sampler_; }
    rhi::BufferSlice node_bits() const { return node_bits_.slice(); }
    rhi::BufferSlice counts() const { return counts_.slice(); }
    rhi::BufferSlice totals() const { return totals_.slice(); }

    /// Pairs that shaders/voxels/octree_scan.comp sums in one group.
    static constexpr uint32_t scan_block = 1024;

  private:
    uint32_t word_count() const;

    uint32_t levels_ = 0;
    rhi::Texture bits_;
    rhi::Buffer node_bits_;
    rhi::Buffer counts_;  ///< nodes and voxels before each word of its block
    rhi::Buffer totals_;  ///< … before each block
    rhi::Buffer sum_;     ///< of all
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::voxels::octree_coarsen> coarsen_;
    rhi::ComputePipeline<shaders::voxels::octree_nodes> nodes_;
    rhi::ComputePipeline<shaders::voxels::octree_scan> scan_;
};

}  // namespace lumo::voxels
