// A whole frame: the techniques that the plan needs, one after the other.
#pragma once

#include <optional>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/bounce/bounce.hpp"
#include "techniques/cones/cones.hpp"
#include "techniques/cones/rays.hpp"
#include "techniques/cones/specular.hpp"
#include "techniques/frame/layers.hpp"
#include "techniques/frame/plan.hpp"
#include "techniques/frame/settings.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/lighting/lighting.hpp"
#include "techniques/post/post.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/sky/sky.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::frame {

/// What a frame shows.
struct Inputs {
    scene::GeometryView geometry;
    scene::Camera camera;
    std::vector<scene::Light> lights;    ///< as shadow::drawn_lights returns them
    glm::vec3 environment_radiance{0};   ///< W/m²/sr
    std::optional<scene::Sky> sky = {};  ///< its sun is among the lights
};

class Frame {
  public:
    /// Makes what the plan needs and nothing else; computes the tables of the sky's air, if it has one. Settings
    /// are resolved (plan.hpp). Errors: those of the techniques; unsupported: a grid that moves, in an octree.
    static Result<Frame> create(rhi::Device& device, const Settings& settings, const Plan& plan,
                                const SceneFacts& facts, const scene::GeometryView& geometry,
                                const scene::Atmosphere* atmosphere = nullptr);

    void record(rhi::Commands& commands, const Inputs& inputs);

    /// What the frame last recorded fills, of a layer that Settings asked for: rgba8_unorm for final, else
    /// rgba32_float. Row 0 is the bottom of the picture.
    const rhi::Texture& texture(Layer layer) const;
    /// What the range of the voxels gave up in the frame last recorded; waits for it. Errors: those of the device.
    Result<uint32_t> dropped_voxel_writes(rhi::Device& device) const;

  private:
    Frame() = default;

    Settings settings_;
    SceneFacts facts_;
    bool emission_ = false;  ///< the volume has it
    bool blend_ = false;     ///< surfaces are blended
    std::optional<gbuffer::GBuffer> gbuffer_;
    std::optional<shadow::Shadow> shadow_;
    std::optional<sky::Sky> sky_;
    bool sky_map_ = false, sky_pixels_ = false;
    std::optional<voxels::Volume> volume_;
    std::optional<cones::Emitters> emitters_;
    std::optional<bounce::Bounce> bounce_;
    std::optional<cones::Irradiance> irradiance_;
    std::optional<cones::Rays> rays_;  ///< in place of irradiance_
    std::optional<cones::Specular> specular_;
    cones::Distribution cones_;    ///< of blended surfaces
    rhi::Sampler volume_sampler_;  ///< … and of specular cones
    std::optional<cones::Irradiance> ao_;
    std::optional<lighting::Lighting> lighting_;
    std::optional<Layers> layers_;
    std::optional<post::Post> post_;
};

}  // namespace lumo::frame
