// Small emitters, for cones to be sent to one by one: cones of fixed directions do not resolve them.
//
// The emitting voxels are summed by the cells of coarse grids: position, extent, flux, mean normal. The finest grid
// that has few enough emitters is taken. Where even the coarsest (8 cells a side) has more, emission is so spread that
// the cones of fixed directions see it well, and it passes over to them; together they stand for all of it once.
#pragma once

#include <cstdint>

#include "rhi/rhi.hpp"
#include "shaders/cones/emitter_cells.hpp"
#include "shaders/cones/emitter_choose.hpp"
#include "shaders/cones/emitter_merge.hpp"
#include "shaders/cones/irradiance.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::cones {

/// The uniform block of emitters of every program that gathers. All zero: no emitters.
using EmitterBlock = shaders::cones::irradiance::Emitters;

class Emitters {
  public:
    /// For volumes of this many voxels a side. Errors: those of the device.
    static Result<Emitters> create(rhi::Device& device, const voxels::Settings& volume);

    /// The emitters of a volume that was voxelized with Needs::emission and Needs::normals: an EmitterBlock.
    rhi::UniformBuffer record(rhi::Commands& commands, const voxels::Volume& volume);

    /// An EmitterBlock, to read it back.
    rhi::BufferSlice block() const { return block_.slice(); }

  private:
    int finest_ = 0;  ///< cells a side of the finest grid
    int levels_ = 0;  ///< grids, each of half as many cells a side as the one before
    rhi::Buffer cells_;
    rhi::Buffer block_;
    rhi::Sampler sampler_;
    rhi::ComputePipeline<shaders::cones::emitter_cells> sum_;
    rhi::ComputePipeline<shaders::cones::emitter_merge> merge_;
    rhi::ComputePipeline<shaders::cones::emitter_choose> choose_;
};

}  // namespace lumo::cones
