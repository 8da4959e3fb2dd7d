// The truth: the light of a scene by unbiased path tracing (Kajiya 1986), for the same scenes, cameras, materials and
// lights as the renderer, with its layers.
//
// What is taken as the renderer takes it: the BRDF and the materials (shaders/common), and that the camera sees
// single-sided surfaces from their front alone. For all other rays both faces stop and reflect light, as in shadow
// maps and voxels; emission leaves a single-sided surface at its front. Beyond it: every analytic light, not the first
// sun alone; reflected light that is not diffuse; textures at full resolution; no occlusion textures, since what they
// stand for is traced. Unlit surfaces show their colour to the camera and are black to light. Light from behind a
// triangle does not reach it, however its shading normal leans.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"
#include "scene/image.hpp"
#include "scene/scene.hpp"

namespace lumo::reference {

/// Linear pictures of three channels, depth of one.
enum class TracedLayer : uint8_t {
    /// direct + indirect + specular + emission, W/m²/sr; under a sky seen through its air, and where nothing is drawn
    /// the sky itself, as SeenSky has them
    radiance,
    direct,      ///< reflected light of analytic lights, by the whole BRDF
    indirect,    ///< light from all else, emitters and environment included, reflected by the diffuse lobe
    irradiance,  ///< what indirect integrates over the hemisphere of the shading normal, W/m²
    specular,    ///< the same light as indirect's, reflected by the specular lobe
    /// Ambient occlusion over the hemisphere of the shading normal: 1 - the integral of cos / pi / (1 + distance /
    /// ao_radius) over what is met; 0 where nothing is drawn, or nothing that light falls on.
    ao,
    /// What reaches the camera unreflected, the environment included: of a sky its map, which is without the sun's disc
    emission,
    albedo,  ///< linear base colour
    normal,  ///< shading normal, world space
    depth,   ///< distance along the optical axis, metres; 0 where nothing is
};
inline constexpr int traced_layer_count = int(TracedLayer::depth) + 1;
std::string_view to_string(TracedLayer layer);
std::optional<TracedLayer> traced_layer_from_string(std::string_view name);

struct PathTracerSettings {
    uint32_t width = 960;
    uint32_t height = 540;
    uint32_t spp = 64;  ///< samples a pixel, 2 and up
    /// n: light is reflected at most n times before the visible surface reflects it; emitted and direct light is
    /// n = 0. None: any number of times, ended by Russian roulette.
    std::optional<uint32_t> bounces = 1;
    uint32_t seed = 1;
    bool diffuse_materials = false;  ///< every surface Lambertian with its base colour, without normal maps
    /// The same for all but the visible surface: reflection as voxels have it, so that what remains between the two
    /// is not the lack of specular light among surfaces.
    bool diffuse_reflectors = false;
    /// Samples at pixel centres, as the renderer without antialiasing has them; else a pixel is the mean over its
    /// square. The layers albedo, normal and depth are always at the centres.
    bool pixel_centers_only = false;
    /// Paths through the air of a sky for each sample of the layer radiance; at least one for each point that a half of a
    /// pixel's samples sees, whose mean they are.
    double air_paths = 0.125;
    float ao_radius = 1;   ///< metres, above 0, where occlusion counts half
    uint32_t threads = 0;  ///< 0: as many as the machine runs at once; the result is the same for any number
    std::vector<TracedLayer> layers{TracedLayer::radiance};
};

/// One layer, row 0 at the top.
struct TracedImage {
    TracedLayer layer = TracedLayer::radiance;
    scene::ImageF mean = {};
    /// The standard error of `mean`, as the difference of two halves of the samples says it for each value by itself:
    /// right on average over many pixels, not in each. Empty for albedo, normal and depth.
    scene::ImageF noise = {};
    /// The part of relative_rmse (metrics.hpp) of any picture against this one that this one's noise makes; adds in
    /// squares. 0 for albedo, normal and depth.
    double relative_noise = 0;
};

struct PathTraced {
    std::vector<TracedImage> layers;  ///< in the order of PathTracerSettings::layers

    /// Of a layer that was asked for.
    const TracedImage& operator[](TracedLayer layer) const;
};

/// Told the part done, 0 to 1, from one thread at a time.
using Progress = std::function<void(double)>;

/// Errors: invalid_argument (no pixels, fewer than two samples), out_of_memory, unsupported (this processor).
Result<PathTraced> path_trace(const scene::Scene& scene, const scene::Camera& camera,
                              const PathTracerSettings& settings, const Progress& progress = {});

}  // namespace lumo::reference
