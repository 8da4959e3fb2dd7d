// The mean over a pattern of 4 x 4 pixels that gather for different directions (shaders/cones/smooth_pattern.comp).
#pragma once

#include <string>

#include "rhi/rhi.hpp"
#include "shaders/cones/smooth_pattern.hpp"
#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::cones {

class PatternMean {
  public:
    /// Makes what is gathered into, of the size: rgba32_float. Errors: those of the device.
    static Result<PatternMean> create(rhi::Device& device, const std::string& name, rhi::Extent size);

    /// What each pixel has gathered.
    rhi::View<rhi::Dimension::d2> gathered() const { return gathered_.view<rhi::Dimension::d2>(); }

    /// Fills `mean`, of the size: at each pixel the mean of those of the pattern that face its way and lie within `reach`
    /// metres of its surface's plane, the farther the less.
    void record(rhi::Pass& pass, const gbuffer::View& gbuffer, float reach,
                rhi::View<rhi::Dimension::d2> mean) const;

  private:
    rhi::Extent size_;
    rhi::Texture gathered_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::cones::smooth_pattern> pipeline_;
};

}  // namespace lumo::cones
