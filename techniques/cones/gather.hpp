// What shaders/cones/gather.glsl reads.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "shaders/cones/irradiance.hpp"
#include "techniques/cones/distribution.hpp"
#include "techniques/cones/emitters.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::cones {

/// The uniform block of every program that gathers.
using GatherBlock = shaders::cones::irradiance::Gather;

/// What the scene needs of a gather: the options of shaders/cones/gather.glsl.
struct Needs {
    bool emission = false;      ///< the volume has emission
    bool environment = false;   ///< light comes from outside the grid
    bool sky = false;           ///< … from a sky
    bool anisotropic = true;    ///< the volume's mips are
    int32_t octree_levels = 0;  ///< as voxels::View
    bool occlusion = false;     ///< how near opacity is, in place of light
};

/// The bindings of shaders/cones/gather.glsl.
struct Gather {
    rhi::Sampled<rhi::Dimension::d3> radiance;
    rhi::Sampled<rhi::Dimension::d3> radiance_directions;
    rhi::Sampled<rhi::Dimension::d3> emission;
    rhi::Sampled<rhi::Dimension::d3> emission_directions;
    rhi::UniformBuffer block;     ///< a GatherBlock
    rhi::UniformBuffer emitters;  ///< an EmitterBlock
    rhi::Sampled<rhi::Dimension::d3> sky;
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> nodes;
};

/// What cones gather from. `environment` is the radiance from outside the grid, W/m²/sr, or, with Needs::sky, `sky` is its
/// map (shaders/sky/map.glsl). `emitters` are the volume's;
/// without them the cones of the distribution see all of its emission. What is `occlusion_radius` away, metres above 0,
/// occludes by half; none: a tenth of the grid's side.
struct Source {
    voxels::View volume;
    glm::vec3 environment{0};
    std::optional<rhi::UniformBuffer> emitters = {};
    std::optional<float> occlusion_radius = {};
    std::optional<rhi::Sampled<rhi::Dimension::d3>> sky = {};
};

/// How cones read volumes: linearly, between mips too, but where those of a pattern read one of them at a time.
rhi::SamplerDesc volume_sampling(const Settings& settings);

/// For programs of this submission. `volume_sampler`: as volume_sampling has it for these cones.
Gather make_gather(rhi::Commands& commands, const Distribution& distribution, const Source& source,
                   rhi::SamplerHandle volume_sampler);

}  // namespace lumo::cones
