// Which blocks of a dense volume hold something, so that nobody visits the rest.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "rhi/rhi.hpp"
#include "shaders/voxels/clear_blocks.hpp"
#include "shaders/voxels/list_blocks.hpp"

namespace lumo::voxels {

/// Fills all mips of volumes with 0. Empty ones are passed over.
void empty_volumes(rhi::Device& device, std::initializer_list<const rhi::Texture*> volumes);

/// Blocks of 4 x 4 x 4 voxels (shaders/voxels/block_list.glsl). What is outside of the list is 0 in every volume, from its
/// creation on (empty_volumes).
class Blocks {
  public:
    /// For `resolution` voxels a side, a multiple of 4. Errors: those of the device.
    static Result<Blocks> create(rhi::Device& device, uint32_t resolution);

    /// What voxelizers mark: a uint32_t a block.
    rhi::BufferSlice marks() const { return marks_.slice(); }
    /// Lists what was marked since, and what was listed before. `keep`: that stays listed as long as this is so.
    void list(rhi::Pass& pass, bool keep) const;

    /// The list, for shaders/voxels/blocks.glsl.
    rhi::BufferSlice list_slice() const { return list_.slice(); }
    /// Indirect dispatch of a group a block.
    rhi::BufferSlice groups() const { return list_.slice(0, arguments_size); }
    /// … for eight of them.
    rhi::BufferSlice groups_of_eight() const { return list_.slice(arguments_stride, arguments_size); }

    /// Empties the listed blocks of an r32_uint volume with so many texels along x a voxel.
    void clear(rhi::Pass& pass, const rhi::Texture& volume, uint32_t words) const;

  private:
    static constexpr uint64_t arguments_size = 12, arguments_stride = 16;

    uint32_t side_ = 0;  ///< of the volume, in blocks
    rhi::Buffer marks_;
    rhi::Buffer list_;
    rhi::ComputePipeline<shaders::voxels::list_blocks> list_blocks_;
    rhi::ComputePipeline<shaders::voxels::clear_blocks> clear_;
};

}  // namespace lumo::voxels
