#include "techniques/frame/plan.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "scene/sky.hpp"

namespace lumo::frame {
namespace {

/// Where the sun lights nothing, the sky is the brightest that is seen, and keeps below white.
float dusk_of(const scene::Sky& sky) {
    constexpr double brightest_of_sky = 4;  // over its mean
    const scene::Daylight light = scene::daylight(sky);
    const double seen = light.sun + brightest_of_sky * light.sky;
    return std::clamp(float(std::log2(full_daylight / seen)), 0.0f, darkest_dusk);
}

}  // namespace

SceneFacts examine(const scene::Scene& scene, const Settings& settings) {
    SceneFacts facts{.triangles = scene.triangle_count()};
    for (const scene::Instance& instance : scene.instances) {
        for (const scene::Primitive& primitive : scene.meshes[instance.mesh].primitives) {
            const scene::Material& material = scene.materials[primitive.material];
            facts.alpha_mask |= material.alpha_mode == scene::AlphaMode::mask;
            facts.alpha_blend |= material.alpha_mode == scene::AlphaMode::blend;
            facts.unlit |= material.unlit;
            facts.normal_maps |= material.normal_texture.has_value() && !settings.diffuse_materials;
            facts.specular |= !material.unlit && !settings.diffuse_materials;
            if (material.emits()) {
                facts.emission = true;
                facts.highest_emission = std::max(
                    {facts.highest_emission, material.emission.r, material.emission.g, material.emission.b});
            }
        }
    }
    facts.sky = scene.sky.has_value();
    if (facts.sky) facts.dusk = dusk_of(*scene.sky);
    facts.environment = facts.sky || scene.environment_radiance != glm::vec3(0);
    for (const scene::Light& light : shadow::drawn_lights(scene.lights)) {
        facts.several_lights |= facts.lights || light.kind != scene::LightKind::directional;
        facts.lights = true;
        facts.light_cameras += shadow::camera_count(light);
    }
    return facts;
}

Settings resolve(Settings settings, const SceneFacts& facts) {
    settings.voxels.range =
        settings.range.value_or(facts.wide_range() ? voxels::Range::fixed : voxels::Range::ldr);
    settings.rays = settings.rays.value_or(settings.gatherer == Gatherer::floor ? 256 : 16);
    settings.post.exposure =
        settings.exposure.value_or(facts.sky ? daylight_exposure + facts.dusk : settings.post.exposure);
    return settings;
}

float ao_radius(const scene::Scene& scene, const Settings& settings) {
    const voxels::Grid grid = voxels::fit_grid(world_bounds(scene), settings.voxels.resolution);
    const float side = settings.voxels.grid_size.value_or(grid.voxel_size * float(grid.resolution));
    return settings.ao_radius.value_or(0.1f * side);
}

bool Plan::needs(std::string_view what) const {
    const auto item =
        std::find_if(items.begin(), items.end(), [&](const PlanItem& i) { return i.what == what; });
    return item != items.end() && item->needed;
}

Plan make_plan(const SceneFacts& facts, const Settings& settings) {
    Plan plan;
    // `possible`: it may be forced, and leaves the picture as it is.
    const auto decide = [&](std::string what, bool needed, std::string if_needed, std::string if_not,
                            bool possible = true) {
        const bool forced = !needed && possible && settings.plan == PlanMode::full;
        plan.items.push_back({std::move(what), needed || forced,
                              needed   ? std::move(if_needed)
                              : forced ? "forced: " + if_not
                                       : std::move(if_not)});
    };

    const bool surfaces = facts.triangles > 0;
    const bool light = facts.lights || facts.emission || facts.environment;
    const bool gi = settings.gi && surfaces && light;
    const std::string no_gi = !settings.gi ? "indirect light is off"
                              : !surfaces  ? "the scene has no triangles"
                                           : "the scene has no light";

    // Opacity is there without light.
    const bool ao = surfaces && settings.wants(Layer::ao);
    const bool opacity = gi || ao;

    decide("gbuffer", true, fmt::format("{} triangles", facts.triangles), "");
    decide("gbuffer.mask", facts.alpha_mask, "some materials are cut out by alpha",
           "no material has alpha mode MASK");
    decide("gbuffer.normal_maps", facts.normal_maps, "some materials have normal maps",
           settings.diffuse_materials ? "materials are taken as diffuse" : "no material has a normal map");
    decide("gbuffer.emission", facts.emission || facts.unlit, "some materials emit or are unlit",
           "no material emits or is unlit");
    decide("shadow", facts.lights && surfaces, "analytic lights cast shadows",
           facts.lights ? "the scene has no triangles" : "the scene has no analytic light");
    decide("voxels", opacity,
           fmt::format("{0}, {1} x {1} x {1}, range {2}", gi ? "indirect light" : "ambient occlusion",
                       settings.voxels.resolution, to_string(settings.voxels.range)),
           no_gi);
    decide("voxels.mask", opacity && facts.alpha_mask, "some materials are cut out by alpha",
           opacity ? "no material has alpha mode MASK" : no_gi);
    decide("voxels.opacity", opacity && facts.alpha_blend, "some materials are blended",
           opacity ? "no material has alpha mode BLEND" : no_gi);
    decide("voxels.emission", gi && facts.emission, "some materials emit", gi ? "no material emits" : no_gi);
    decide("voxels.light", gi && facts.lights, "the light of analytic lights is injected",
           gi ? "the scene has no analytic light" : no_gi);
    decide("voxels.bounce", gi && (facts.emission || facts.environment || settings.bounces > 1),
           "voxels gather light from each other",
           gi ? "all light is that of analytic lights, reflected once by injection" : no_gi);
    const bool by_cones = settings.gatherer == Gatherer::cones;
    decide("cones", gi && by_cones, fmt::format("{} cones a pixel", settings.cones.count),
           by_cones ? no_gi : "rays gather in their place", by_cones);
    // What is asked for in place of cones: not for a full plan, which shows the same picture.
    if (!by_cones) decide("cones.rays", gi, fmt::format("{} rays a pixel", settings.rays.value_or(0)), no_gi);
    decide("cones.emitters", gi && facts.emission, "small emitters are lit by one by one",
           gi ? "no material emits" : no_gi);
    decide("cones.specular", gi && facts.specular, "materials have a specular lobe",
           !gi                          ? no_gi
           : settings.diffuse_materials ? "materials are taken as diffuse"
                                        : "every material is unlit",
           !settings.diffuse_materials);
    decide("sky.map", gi && facts.sky, "cones that leave the scene see the sky",
           gi ? "the scene has no sky" : no_gi);
    const bool shown = settings.wants(Layer::final) || settings.wants(Layer::radiance);
    decide("sky.pixels", facts.sky && shown, "the sky is seen, and surfaces through its air",
           facts.sky ? "no layer shows the sky" : "the scene has no sky");
    decide("cones.environment", gi && facts.environment, "light comes from outside the scene",
           gi ? "the environment is black" : no_gi);
    decide("cones.ao", ao, "the layer ao is asked for",
           surfaces ? "the layer ao is not asked for" : "the scene has no triangles");
    decide("lighting", true, "every pixel has a radiance", "");
    decide("lighting.specular", facts.specular, "materials have a specular lobe",
           settings.diffuse_materials ? "materials are taken as diffuse" : "every material is unlit",
           !settings.diffuse_materials);
    decide("blend", facts.alpha_blend, "some materials are blended", "no material has alpha mode BLEND");
    decide("blend.air", facts.alpha_blend && facts.sky && shown,
           "blended surfaces are seen through the sky's air",
           !facts.alpha_blend ? "no material has alpha mode BLEND"
           : facts.sky        ? "no layer shows the sky"
                              : "the scene has no sky");
    decide("post", settings.wants(Layer::final), "the picture is for a display",
           "no layer is display-referred");
    return plan;
}

std::string to_text(const Plan& plan) {
    std::string text;
    for (const PlanItem& item : plan.items) {
        text += fmt::format("  {:<8} {:<22} {}\n", item.needed ? "needed" : "left out", item.what, item.why);
    }
    return text;
}

}  // namespace lumo::frame
