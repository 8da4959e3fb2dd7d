// What a user chooses about a frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "rhi/work.hpp"
#include "techniques/cones/cones.hpp"
#include "techniques/cones/rays.hpp"
#include "techniques/post/post.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/sky/sky.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::frame {

/// The pictures that a frame can hand out. All but final are linear and unexposed.
enum class Layer : uint8_t {
    final,       ///< display-referred, rgba8_unorm
    radiance,    ///< direct + indirect + specular + emission, W/m²/sr
    direct,      ///< reflected light of analytic lights
    indirect,    ///< reflected light that cones gathered
    irradiance,  ///< what indirect reflects, W/m²
    specular,    ///< indirect light that the specular lobe reflects
    ao,          ///< ambient occlusion: 1 where nothing is near, 0 where all is hidden or nothing is drawn
    emission,
    albedo,
    normal,  ///< shading normal, world space
    depth,   ///< distance along the optical axis, metres; 0 where nothing is
    voxels,  ///< radiance of the voxels as the camera sees them
};
inline constexpr int layer_count = int(Layer::voxels) + 1;
std::string_view to_string(Layer layer);
std::optional<Layer> layer_from_string(std::string_view name);

enum class PlanMode : uint8_t { automatic, full };

/// What gathers the diffuse indirect light of visible surfaces: cones; rays through the finest voxels; or, to measure what
/// those lose, many such rays, for each pixel by itself and with no treatment of emitters.
enum class Gatherer : uint8_t { cones, rays, floor };

/// Stops at which a white wall in sunlight is about white.
inline constexpr float daylight_exposure = -5;
/// The light that those are for, W/m² (scene::Daylight); and how many more a darker sky gets at most: nights stay dark.
inline constexpr double full_daylight = 200;
inline constexpr float darkest_dusk = 10;

struct Settings {
    rhi::Extent size{960, 540};  ///< pixels
    bool gi = true;
    bool diffuse_materials = false;
    uint32_t bounces = 1;
    std::vector<Layer> layers{Layer::final};
    PlanMode plan = PlanMode::automatic;
    voxels::Settings voxels = {};
    std::optional<voxels::Range> range = {};  ///< voxels.range; none: what the scene's light needs
    cones::Settings cones = {};
    Gatherer gatherer = Gatherer::cones;
    /// A pixel, 1 to cones::max_rays, where they gather; none: 16, or 256 of the floor.
    std::optional<uint32_t> rays = {};
    /// Metres, above 0, where occlusion counts half; none: a tenth of the grid's side.
    std::optional<float> ao_radius = {};
    shadow::Settings shadow = {};
    sky::Settings sky = {};
    /// post.exposure; none: that, or under a sky daylight_exposure, and more in dusk.
    std::optional<float> exposure = {};
    post::Settings post = {};

    bool wants(Layer layer) const;
};

}  // namespace lumo::frame
