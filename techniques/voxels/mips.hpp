// Isotropic mips of a volume.
#pragma once

#include "rhi/rhi.hpp"
#include "shaders/voxels/mip.hpp"

namespace lumo::voxels {

class Mips {
  public:
    static Result<Mips> create(rhi::Device& device);

    /// Each mip of a cubic volume from the one above it: the mean of eight, colours being stored times
    /// opacity.
    void record(rhi::Pass& pass, const rhi::Texture& volume) const;

  private:
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::voxels::mip> pipeline_;
};

}  // namespace lumo::voxels
