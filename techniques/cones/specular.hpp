// Indirect light that the specular lobe reflects, by cones along the lobe.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "rhi/rhi.hpp"
#include "shaders/cones/specular.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::cones {

/// What the specular lobe of shaders/common/brdf.glsl reflects of a constant environment is F0 x + y: for `side` values
/// of n·v (first) and of perceptual roughness, from 0 to 1.
std::vector<glm::vec2> specular_reflectance(uint32_t side);

class Specular {
  public:
    /// Makes a target of the size. Errors: those of the device.
    static Result<Specular> create(rhi::Device& device, const Needs& needs, rhi::Extent size);

    /// Radiance toward the eye, W/m²/sr; 0 where nothing was drawn. `irradiance` is that of the same pixels. Returns
    /// rgba32_float, a is 1.
    rhi::View<rhi::Dimension::d2> record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                         const Gather& gather, rhi::View<rhi::Dimension::d2> irradiance);

  private:
    rhi::Extent size_;
    rhi::Texture specular_;
    rhi::Texture reflectance_;
    rhi::Sampler point_sampler_;
    rhi::Sampler linear_sampler_;
    rhi::ComputePipeline<shaders::cones::specular> pipeline_;
};

}  // namespace lumo::cones
