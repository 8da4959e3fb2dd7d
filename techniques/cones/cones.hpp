// Indirect light at the pixels of a G-buffer, by cones through a voxel volume.
#pragma once

#include <optional>
#include <string_view>

#include "rhi/rhi.hpp"
#include "shaders/cones/irradiance.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/cones/pattern_mean.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::cones {

class Irradiance {
  public:
    /// Makes a target of the size. Errors: those of the device.
    static Result<Irradiance> create(rhi::Device& device, const Settings& settings, const Needs& needs,
                                     rhi::Extent size);

    /// Irradiance of indirect light, W/m², over the hemisphere of each pixel's shading normal; 0 where
    /// nothing was drawn. Returns rgba32_float, a is 1. With Needs::occlusion, in a pass of its own name, ambient
    /// occlusion in its place: 1 - the integral over that hemisphere of cos / pi / (1 + distance / radius) where opacity
    /// is met (the decay of Crassin et al. 2011); 1 is unoccluded; r, g and b are the same.
    ///
    /// Where Settings::turned, 4 x 4 pixels have cones of their own, and each takes the mean of those that lie in its plane
    /// and face its way (shaders/cones/smooth_pattern.comp).
    rhi::View<rhi::Dimension::d2> record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                         const Source& source);

    /// What record() fills, to copy it from.
    const rhi::Texture& irradiance() const { return irradiance_; }

  private:
    Distribution distribution_;
    std::string_view name_;
    rhi::Extent size_;
    rhi::Texture irradiance_;
    std::optional<PatternMean> mean_;  ///< where there is a pattern
    rhi::Sampler volume_sampler_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::cones::irradiance> pipeline_;
};

}  // namespace lumo::cones
