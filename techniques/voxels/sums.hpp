// Fragments of surfaces summed per cell, a cell being a voxel of a dense volume, or of an octree's list.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/voxels/voxelize.hpp"
#include "shaders/voxels/voxelize_exchange.hpp"
#include "shaders/voxels/voxelize_exchange_large.hpp"
#include "shaders/voxels/voxelize_exchange_small.hpp"
#include "shaders/voxels/voxelize_large.hpp"
#include "shaders/voxels/voxelize_small.hpp"
#include "techniques/voxels/blocks.hpp"
#include "techniques/voxels/range.hpp"
#include "techniques/voxels/voxelizer.hpp"

namespace lumo::voxels {

/// What says where a voxel's cell is, an octree's nodes and records, and which blocks of a dense volume hold something.
/// Either storage binds something that nobody uses in place of the other's.
struct CellLookup {
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> octree_nodes;
    rhi::StorageBuffer records;
    rhi::StorageBuffer block_marks;
};

/// Where voxelizers add by atomics alone.
struct AddedSums {
    using Raster = shaders::voxels::voxelize;
    using Small = shaders::voxels::voxelize_small;
    using Large = shaders::voxels::voxelize_large;

    Raster::Bindings raster(const DrawSources& draw) const;
    template <class P>
    typename P::Bindings compute(const DrawSources& draw, const LargeTriangles& large) const;

    rhi::View<rhi::Dimension::d3> sums;
    CellLookup lookup;
};

/// Where voxelizers exchange words too.
struct ExchangedSums {
    static constexpr bool draws_alone = true;
    using Raster = shaders::voxels::voxelize_exchange;
    using Small = shaders::voxels::voxelize_exchange_small;
    using Large = shaders::voxels::voxelize_exchange_large;

    Raster::Bindings raster(const DrawSources& draw) const;
    template <class P>
    typename P::Bindings compute(const DrawSources& draw, const LargeTriangles& large) const;

    rhi::View<rhi::Dimension::d3> sums;
    rhi::View<rhi::Dimension::d3> exchanged;
    rhi::View<rhi::Dimension::d3> floats;
    rhi::StorageBuffer dropped;
    CellLookup lookup;
};

struct SumsSettings {
    Range range = Range::ldr;
    VoxelizerKind voxelizer = VoxelizerKind::compute;
    int32_t octree_levels = 0;
    bool emission = false;     ///< some surface emits
    bool translucent = false;  ///< some surface is blended
    bool normals = false;      ///< surfaces' normals are summed as well
    bool keep = false;         ///< sums of surfaces outlive those of emission, for move()
};

class Sums {
  public:
    /// Room for `cells`. Errors: those of the device; limit when its 3D textures are too small.
    static Result<Sums> create(rhi::Device& device, const SumsSettings& settings, const VoxelizerNeeds& needs,
                               rhi::Extent cells);

    /// Base colour, normals and opacity of all surfaces, in place of what was summed before. `listed`: of a dense volume,
    /// where something was; none of an octree.
    void add_surfaces(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
                      const CellLookup& lookup, const Blocks* listed);
    /// Moves the draws of these numbers from where `before` has them to where `after` has them, in what was added last;
    /// the sums are then what adding all of `after` would make. `emission`: that, times `scale`, instead of surfaces. Of
    /// an order-free range, kept.
    void move(rhi::Commands& commands, const scene::GeometryView& before, const scene::GeometryView& after,
              std::span<const uint32_t> draws, const Grid& grid, const CellLookup& lookup, bool emission,
              float scale);
    /// Emission of those that emit, times `scale`, likewise.
    void add_emission(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
                      const CellLookup& lookup, const Blocks* listed, float scale);

    // What shaders/voxels/means.glsl reads; layout: shaders/voxels/accumulator.glsl.
    const rhi::Texture& sums(bool emission = false) const { return sums_[emission && settings_.keep]; }
    const rhi::Texture& exchanged() const { return exchanged_; }
    const rhi::Texture& floats() const { return floats_; }
    /// uint32_t: writes that were given up since the last add_surfaces.
    rhi::BufferSlice dropped() const { return dropped_.slice(); }

  private:
    Result<void> create_textures(rhi::Device& device, rhi::Extent cells);
    void clear(rhi::Pass& pass, const Blocks* listed, bool emission) const;
    Result<void> create_voxelizers(rhi::Device& device, const VoxelizerNeeds& needs);
    template <class Wanted>
    void add(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
             const CellLookup& lookup, const Blocks* listed, bool emission, float scale,
             const Wanted& wanted);

    uint32_t texels_a_cell() const;

    SumsSettings settings_;
    /// Layout: shaders/voxels/accumulator.glsl; the second for emission, if both are kept.
    rhi::Texture sums_[2];
    rhi::Texture exchanged_;  ///< one texel where the range exchanges nothing
    rhi::Texture floats_;     ///< one texel unless the range is mutex
    rhi::Buffer dropped_;
    /// By what is summed, surfaces or emission; of the two kinds the one that the range is of.
    std::optional<Voxelizer<AddedSums>> added_[2];
    std::optional<Voxelizer<ExchangedSums>> exchanged_by_[2];
};

}  // namespace lumo::voxels
