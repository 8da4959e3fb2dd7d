// Indirect light at the pixels of a G-buffer, by cones through a voxel volume.
#pragma once

#include <glm/glm.hpp>
#include <string_view>

#include "rhi/rhi.hpp"
#include "shaders/cones/irradiance.hpp"
#include "shaders/cones/smooth_pattern.hpp"
#include "techniques/cones/gather.hpp"
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
    /// One set of cones for all places, for those who gather without taking the mean over a pattern.
    const Distribution& plain_distribution() const { return plain_; }
    /// The sampler that volumes are read through.
    rhi::SamplerHandle volume_sampler() const { return volume_sampler_; }
    rhi::SamplerHandle point_sampler() const { return point_sampler_; }

  private:
    Distribution plain_;
    Distribution distribution_;
    std::string_view name_;
    rhi::Extent size_;
    rhi::Texture gathered_;  ///< before the mean over the pattern is taken, where there is one
    rhi::Texture irradiance_;
    rhi::Sampler volume_sampler_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::cones::irradiance> pipeline_;
    rhi::ComputePipeline<shaders::cones::smooth_pattern> smooth_;
};

}  // namespace lumo::cones
