// Irradiance at the pixels of a G-buffer by rays through the finest voxels: no mips, no widths.
//
// A few rays a pixel and the mean over a pattern stand in for cones. Many, without a pattern and without emitters, are the
// floor of what cones and rays can reach: what is between it and the truth, the voxels have lost.
#pragma once

#include <cstdint>
#include <optional>

#include "rhi/rhi.hpp"
#include "shaders/cones/rays.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/cones/pattern_mean.hpp"
#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::cones {

inline constexpr uint32_t max_rays = 16'384;

struct RaySettings {
    uint32_t count = 16;  ///< a pixel, 1 to max_rays
    /// Each pixel takes the mean over the 4 x 4 of the pattern that lie in its plane and face its way, whose rays are
    /// together spread as evenly as its own.
    bool smoothed = true;
};

class Rays {
  public:
    /// Makes a target of the size. Of Needs, what is about mips counts for what stands before emitters alone.
    /// Errors: those of the device.
    static Result<Rays> create(rhi::Device& device, const RaySettings& settings, const Needs& needs,
                               rhi::Extent size);

    /// Irradiance of indirect light, W/m², over the hemisphere of each pixel's shading normal, as
    /// Irradiance::record: emitters one by one, where the source has them, what they do not stand for by rays. Returns
    /// rgba32_float, a is 1.
    ///
    /// Rays are spread by the cosine, the same in every run. One starts above the surface by the sum of the geometric
    /// normal's magnitudes, 1 to 1.73 voxels: the least at which it can meet no voxel that the surface's plane goes
    /// through. It walks from voxel to voxel, over blocks that hold nothing in one step; a voxel is opaque, or as
    /// translucent as its opacity and the path in it say, and of one radiance. In dispatches of a few million rays at
    /// most, so that no driver takes one for hung.
    rhi::View<rhi::Dimension::d2> record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                         const Source& source);

  private:
    uint32_t rays_ = 1;
    rhi::Extent size_;
    rhi::Texture irradiance_;
    std::optional<PatternMean> mean_;
    rhi::Sampler volume_sampler_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::cones::rays> pipeline_;
};

}  // namespace lumo::cones
