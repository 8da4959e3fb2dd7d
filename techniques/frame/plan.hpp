// What a frame of this scene needs, and why the rest is left out.
//
// The plan is made before anything is allocated or compiled, from the scene and the settings alone; nothing
// outside it exists afterwards. It never changes a setting.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "techniques/frame/settings.hpp"

namespace lumo::frame {

/// What a plan has to know of a scene.
struct SceneFacts {
    uint64_t triangles = 0;
    bool alpha_mask = false;   ///< some surface of an instance is cut out by alpha
    bool alpha_blend = false;  ///< … blended
    bool emission = false;     ///< … emits light
    bool unlit = false;        ///< … shows its colour as it is
    bool normal_maps = false;
    bool specular = false;        ///< some lit surface is not purely diffuse under these settings
    bool environment = false;     ///< light comes from outside the scene
    bool sky = false;             ///< … of an atmosphere
    float dusk = 0;               ///< stops from a high sun's light down to that sky's, at most darkest_dusk
    bool lights = false;          ///< analytic lights shine
    bool several_lights = false;  ///< … and not one directional light alone
    uint32_t light_cameras = 0;   ///< shadow maps that they need
    /// Radiance spans more than 8 bits hold: emitters and what they light, or a sky and what it does not reach.
    bool wide_range() const { return emission || environment || several_lights; }
    float highest_emission = 0;  ///< radiance, W/m²/sr, the largest channel of any surface, before textures
};

/// Counts only what instances use.
SceneFacts examine(const scene::Scene& scene, const Settings& settings);

/// The settings with what they leave to the scene decided. Plans and frames are made of these.
Settings resolve(Settings settings, const SceneFacts& facts);

/// Settings::ao_radius, or what stands for it in this scene; metres.
float ao_radius(const scene::Scene& scene, const Settings& settings);

/// One thing that a frame may hold.
struct PlanItem {
    std::string what;  ///< as passes and resources name it
    bool needed = false;
    std::string why;  ///< one line, either way
};

struct Plan {
    std::vector<PlanItem> items;

    bool needs(std::string_view what) const;
};

/// `full` takes everything, needed or not; the reason says so.
Plan make_plan(const SceneFacts& facts, const Settings& settings);

/// A line per item: what, needed or left out, why.
std::string to_text(const Plan& plan);

}  // namespace lumo::frame
