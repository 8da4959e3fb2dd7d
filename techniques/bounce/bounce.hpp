// Light reflected on from voxel to voxel.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "rhi/rhi.hpp"
#include "shaders/bounce/bounce.hpp"
#include "shaders/bounce/rays.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::bounce {

struct Settings {
    /// Reflections before the light reaches the surface that the camera sees, at least 1.
    uint32_t bounces = 1;
    cones::Settings cones = {};
    /// Rays a voxel through the finest voxels, in place of cones, at most max_rays; 0: cones.
    uint32_t rays = 0;
};

/// What a voxel gathers is seen by many rays or cones: more of its own change no picture by half a percent.
inline constexpr uint32_t max_rays = 4;

/// What lights the scene beside analytic lights, and how many those are.
struct Needs {
    bool emission = false;
    bool environment = false;
    bool sky = false;             ///< the environment is a sky
    bool several_lights = false;  ///< as voxels::Needs

    constexpr bool any_light() const { return emission || environment; }
};

/// Gathers needed for a number of bounces: the first reflection of analytic lights is injected, that of emitters and
/// environment is gathered.
constexpr uint32_t gathers(const Settings& settings, const Needs& needs) {
    return settings.bounces - (needs.any_light() ? 0 : 1);
}

class Bounce {
  public:
    /// gathers() is at least 1. Errors: those of the device.
    static Result<Bounce> create(rhi::Device& device, const Settings& settings, const Needs& needs,
                                 const voxels::Volume& volume);

    /// What the light of `source`, which is that of `volume` after the injection, became after all bounces: the same
    /// view with another radiance.
    voxels::View record(rhi::Commands& commands, const voxels::Volume& volume, cones::Source source);

  private:
    Settings settings_;
    Needs needs_;
    cones::Distribution distribution_;
    /// Written in turn; the second only for two gathers or more.
    std::array<voxels::LightVolume, 2> radiance_;
    rhi::Sampler volume_sampler_;
    template <rhi::Program P>
    struct Pipelines {
        rhi::ComputePipeline<P> first;  ///< leaves reflected light out
        rhi::ComputePipeline<P> next;
    };
    template <rhi::Program P>
    Result<void> create_pipelines(rhi::Device& device, const voxels::Volume& volume, Pipelines<P>& pipelines);
    template <rhi::Program P>
    void gather(rhi::Pass& pass, const voxels::Volume& volume, const Pipelines<P>& pipelines, bool first,
                const cones::Gather& source, const voxels::LightVolume& target) const;

    Pipelines<shaders::bounce::bounce> by_cones_;
    Pipelines<shaders::bounce::rays> by_rays_;
};

}  // namespace lumo::bounce
