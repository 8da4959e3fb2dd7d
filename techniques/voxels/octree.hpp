// A sparse voxel octree: what a dense volume holds, of the nodes alone that hold something.
//
// Its structure is described in shaders/voxels/octree.glsl. Surfaces are kept in a list of the occupied voxels, in cells
// of small volumes, so that the programs that fill a dense volume fill it too; light is spread from there to bricks,
// which cones sample, with the values that the volume has, to the bit.
#pragma once

#include <cstdint>
#include <string>

#include "rhi/rhi.hpp"
#include "shaders/voxels/octree_fill.hpp"
#include "shaders/voxels/octree_index.hpp"
#include "shaders/voxels/octree_mip.hpp"
#include "shaders/voxels/octree_mip_wide.hpp"
#include "techniques/voxels/light_volume.hpp"
#include "techniques/voxels/occupancy.hpp"

namespace lumo::voxels {

/// Texels along a brick of shaders/voxels/octree.glsl: four voxels, and the one that follows them.
inline constexpr uint32_t brick_side = 5;

struct OctreeSettings {
    uint32_t resolution = 128;  ///< voxels a side, a power of two, 16 to 1024
    MipKind mips = MipKind::anisotropic;
    bool wide_range = false;   ///< radiance needs more than 8 bits
    bool list_voxels = false;  ///< somebody asks where the voxels of the list are
};

class Octree {
  public:
    /// Makes room for an octree of this size; what later exceeds it is left out, the last nodes first. Errors: those of
    /// the device; limit when its 3D textures are too small.
    static Result<Octree> create(rhi::Device& device, const OctreeSettings& settings, const OctreeSize& size);

    Occupancy& occupancy() { return occupancy_; }
    /// Once Occupancy is recorded: the nodes' slots and the list of voxels.
    void index(rhi::Commands& commands);

    /// Bricks for one kind of light, as shaders/voxels/octree.glsl lays them out: level 0 as the base, the coarser
    /// levels as the directions, isotropic or not.
    Result<LightVolume> create_light(rhi::Device& device, const std::string& name) const;
    /// Light of the voxels in the list: what fill() spreads.
    const rhi::Texture& cells() const { return cells_; }
    /// All levels from cells().
    void fill(rhi::Pass& pass, const LightVolume& light) const;

    /// Texels of any volume over the list.
    rhi::Extent cell_extent() const { return cell_extent_; }
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> nodes() const;
    const rhi::Texture& node_texture() const { return nodes_; }  ///< rg32_uint, a mip a level
    rhi::BufferSlice records() const { return records_.slice(); }
    /// Per voxel of the list its x, y and z, 10 bits each; 4 bytes where list_voxels is not set.
    rhi::BufferSlice voxels() const { return voxels_.slice(); }
    uint32_t levels() const { return occupancy_.levels(); }

  private:
    Result<void> create_pipelines(rhi::Device& device);

    OctreeSettings settings_;
    OctreeSize size_;
    rhi::Extent cell_extent_;
    Occupancy occupancy_;
    rhi::Texture nodes_;
    rhi::Buffer records_;
    rhi::Buffer voxels_;
    rhi::Texture cells_;
    rhi::ComputePipeline<shaders::voxels::octree_index> index_;
    rhi::ComputePipeline<shaders::voxels::octree_fill> fill_;
    /// By what they are made from: level 0, or a level with directions.
    rhi::ComputePipeline<shaders::voxels::octree_mip> mip_[2];
    rhi::ComputePipeline<shaders::voxels::octree_mip_wide> mip_wide_[2];
};

}  // namespace lumo::voxels
