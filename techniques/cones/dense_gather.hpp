// The floor of what cones can reach: irradiance at the pixels of a G-buffer by many rays through the finest voxels.
//
// It is for measuring: the same inputs as cones, without mips, without widths, and without a treatment of emitters. What
// is between it and the truth, the voxels have lost; what is between it and cones' irradiance, the cones.
#pragma once

#include <cstdint>

#include "rhi/rhi.hpp"
#include "shaders/cones/dense_gather.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::cones {

inline constexpr uint32_t max_rays = 16'384;

class DenseGather {
  public:
    /// Makes a target of the size. `rays` a pixel, 1 to max_rays. Of Needs, what is about cones alone counts nothing.
    /// Errors: those of the device.
    static Result<DenseGather> create(rhi::Device& device, uint32_t rays, const Needs& needs,
                                      rhi::Extent size);

    /// Irradiance of indirect light, W/m², over the hemisphere of each pixel's shading normal, as
    /// Irradiance::record; all emission is met by rays. Returns rgba32_float, a is 1.
    ///
    /// Rays are spread by the cosine, the same in every run. One starts above the surface by the sum of the geometric
    /// normal's magnitudes, 1 to 1.73 voxels: the least at which it can meet no voxel that the surface's plane goes
    /// through. It walks from voxel to voxel; each is opaque, or as translucent as its opacity and the path in it say, and
    /// of one radiance. In dispatches of a few million rays at most, so that no driver takes one for hung.
    rhi::View<rhi::Dimension::d2> record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                         const Source& source);

  private:
    uint32_t rays_ = 1;
    rhi::Extent size_;
    rhi::Texture irradiance_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::cones::dense_gather> pipeline_;
};

}  // namespace lumo::cones
