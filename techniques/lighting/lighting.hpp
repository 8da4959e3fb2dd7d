// Radiance toward the eye: a deferred pass over the G-buffer, then blended surfaces drawn over it from back to front.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/lighting/add.hpp"
#include "shaders/lighting/blended.hpp"
#include "shaders/lighting/blended_indirect.hpp"
#include "shaders/lighting/shade.hpp"
#include "shaders/lighting/shade_layers.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/sky/sky.hpp"

namespace lumo::lighting {

/// What the scene and the user need of the lighting; nothing else is made.
struct Needs {
    bool lights = false;              ///< there are analytic lights
    bool indirect = false;            ///< there is irradiance of indirect light
    bool specular = false;            ///< there is indirect light of the specular lobe
    bool emission = false;            ///< the G-buffer has the target of emission
    bool sky = false;                 ///< a sky is seen, and surfaces through its air
    bool sky_in_parts = false;        ///< … of more than four wavelengths
    bool layers = false;              ///< direct and indirect radiance are wanted by themselves
    bool blend = false;               ///< some surface is blended
    bool blend_air = false;           ///< … through the air of a sky
    bool blend_double_sided = false;  ///< … and seen from both sides
    bool blend_mirrored = false;      ///< … and in an instance that turns the winding
    bool diffuse_materials = false;   ///< every surface is Lambertian with its base colour
    cones::Needs gather = {};         ///< for blended surfaces under indirect light
};

/// The needs of a scene's blended draws.
Needs blend_needs_of(const scene::GeometryView& geometry);

struct Inputs {
    gbuffer::View gbuffer;
    std::optional<shadow::View> lights = {};  ///< if Needs::lights
    std::optional<rhi::View<rhi::Dimension::d2>> irradiance =
        {};  ///< if Needs::indirect; W/m², of G-buffer pixels
    std::optional<rhi::View<rhi::Dimension::d2>> specular =
        {};                                    ///< if Needs::specular; W/m²/sr, of G-buffer pixels
    std::optional<cones::Gather> gather = {};  ///< if Needs::indirect and Needs::blend
    std::optional<sky::Pixels> sky = {};       ///< if Needs::sky
    glm::vec3 environment{0};                  ///< radiance seen where nothing was drawn, W/m²/sr
    /// For the blended surfaces, if Needs::blend.
    std::optional<scene::GeometryView> geometry = {};
    glm::vec4 eye{0, 0, 0, 1};  ///< CameraBlock::eye, to sort them by
};

/// rgba32_float, W/m²/sr. `radiance` = direct + indirect + specular + emission + environment, blended surfaces over it; the
/// layers `direct` and `indirect` are of what lies behind those. The air of a sky is before all surfaces, in `radiance` alone.
struct View {
    rhi::View<rhi::Dimension::d2> radiance;
    std::optional<rhi::View<rhi::Dimension::d2>> direct;
    std::optional<rhi::View<rhi::Dimension::d2>> indirect;
};

class Lighting {
  public:
    /// Errors: those of the device; unsupported when it cannot blend rgba32_float and there is something to blend.
    static Result<Lighting> create(rhi::Device& device, rhi::Extent size, const Needs& needs);

    View record(rhi::Commands& commands, const Inputs& inputs);

    // The targets, to read them back; the layers are empty without Needs::layers.
    const rhi::Texture& radiance() const { return radiance_; }
    const rhi::Texture& direct() const { return direct_; }
    const rhi::Texture& indirect() const { return indirect_; }

  private:
    /// The bindings of shaders/common/lights.glsl.
    struct AnalyticLights {
        rhi::UniformBuffer block;
        rhi::Sampled<rhi::Dimension::d2_array> shadow_maps;
    };

    template <class P>
    using BlendPipelines = std::array<rhi::RasterPipeline<P>, 3>;  ///< by CullMode

    template <class P>
    Result<void> make_blend_pipelines(rhi::Device& device, BlendPipelines<P>& pipelines,
                                      const typename P::Options& options);
    template <class P>
    void draw_blended(rhi::RasterPass& pass, const BlendPipelines<P>& pipelines, const Inputs& inputs,
                      const AnalyticLights& lights, const sky::Air& air) const;
    void blend(rhi::Commands& commands, const Inputs& inputs, const AnalyticLights& lights);

    Needs needs_;
    rhi::Sampler sampler_;
    rhi::Texture no_shadow_maps_;  ///< bound where there are no lights
    rhi::Texture radiance_;
    rhi::Texture direct_;
    rhi::Texture indirect_;
    rhi::Texture share_;  ///< blended surfaces, by what they send at some of the wavelengths
    rhi::ComputePipeline<shaders::lighting::add> add_;
    rhi::ComputePipeline<shaders::lighting::shade> shade_;
    rhi::ComputePipeline<shaders::lighting::shade_layers> shade_layers_;
    BlendPipelines<shaders::lighting::blended> blended_;
    BlendPipelines<shaders::lighting::blended_indirect> blended_indirect_;
};

}  // namespace lumo::lighting
