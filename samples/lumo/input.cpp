#include "samples/lumo/input.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "samples/lumo/names.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/gltf.hpp"
#include "scene/printable.hpp"
#include "scene/sky.hpp"
#include "techniques/shadow/shadow.hpp"

namespace lumo::program {
namespace {

bool is_builtin(const std::string& name) {
    return std::ranges::find(scene::builtin_names(), name) != scene::builtin_names().end();
}

bool shines(const scene::Light& light) {
    return light.kind == scene::LightKind::directional && light.intensity != glm::vec3(0);
}

// So that neither plane cuts the scene, and depth is as fine as it can be.
void set_planes(scene::Camera& camera, const scene::Bounds& bounds) {
    if (bounds.empty()) return;
    constexpr float largest_near = 0.05f;
    const glm::vec3 farthest =
        glm::max(glm::abs(bounds.min - camera.position), glm::abs(bounds.max - camera.position));
    camera.far_plane = std::max(1.01f * glm::length(farthest), 1e-3f);
    camera.near_plane = std::min(largest_near, 0.01f * camera.far_plane);
}

/// The sky that the options ask for, in place of all that lit the scene from far away.
Result<void> give_sky(scene::Scene& scene, const Options& options) {
    if (options.sun && options.sun->irradiance == glm::vec3(0))
        return fail(ErrorKind::invalid_argument, "--sun", "a sky needs a sun",
                    "give its direction, also below the horizon, with any irradiance above 0");
    scene::Sky sky = scene.sky.value_or(scene::Sky{});
    if (options.sun) {
        sky.direction_to_sun = options.sun->direction_to_sun;
    } else if (!scene.sky) {
        if (sun_of(scene).irradiance == glm::vec3(0)) {
            add_daylight(scene);
            scene.warnings.emplace_back("it has no sun: one is put high above it (--sun moves it)");
        }
        sky.direction_to_sun = sun_of(scene).direction_to_sun;
    }
    if (options.altitude_km) sky.altitude_km = *options.altitude_km;
    if (!options.atmosphere.empty()) {
        auto atmosphere = scene::load_atmosphere(options.atmosphere);
        if (!atmosphere) return tl::unexpected(atmosphere.error());
        sky.atmosphere = std::move(*atmosphere);
    }
    set_sky(scene, std::move(sky));
    return {};
}

}  // namespace

Result<scene::Scene> load_scene(const Options& options) {
    Result<scene::Scene> scene = [&]() -> Result<scene::Scene> {
        if (is_builtin(options.scene)) {
            auto made = scene::make_builtin(options.scene);
            if (made && options.photometric)
                made->warnings.emplace_back("--photometric is about files: built-in scenes are radiometric");
            return made;
        }
        const std::string extension = extension_of(options.scene);
        if (extension != ".gltf" && extension != ".glb")
            return fail(ErrorKind::invalid_argument, scene::printable(options.scene),
                        "there is no such scene",
                        fmt::format("give a .gltf or .glb file, or one of {}",
                                    fmt::join(scene::builtin_names(), ", ")));
        return scene::load_gltf(options.scene, {}, {.photometric = options.photometric});
    }();
    if (scene && (options.sky || scene->sky)) {
        if (const Result<void> done = give_sky(*scene, options); !done) return tl::unexpected(done.error());
        return scene;
    }
    if (scene && (!options.atmosphere.empty() || options.altitude_km))
        return fail(ErrorKind::invalid_argument, options.altitude_km ? "--altitude" : "--atmosphere",
                    "the scene has no sky", "give --sky on");
    if (scene && options.sun) replace_sun(*scene, *options.sun);
    if (scene && !options.sun && !has_light(*scene)) {
        add_daylight(*scene);
        scene->warnings.emplace_back(
            "it has no light: daylight is added (--sun sets another, --sun none keeps it dark)");
    }
    return scene;
}

void replace_sun(scene::Scene& scene, const Sun& sun) {
    if (scene.sky) {
        scene::Sky sky = *scene.sky;
        sky.direction_to_sun = sun.direction_to_sun;
        set_sky(scene, std::move(sky));
        return;
    }
    std::erase_if(scene.lights,
                  [](const scene::Light& light) { return light.kind == scene::LightKind::directional; });
    if (sun.irradiance == glm::vec3(0)) return;
    scene.lights.push_back(
        {.name = "--sun", .intensity = sun.irradiance, .direction = -sun.direction_to_sun});
}

Sun sun_of(const scene::Scene& scene) {
    if (scene.sky)
        return {.direction_to_sun = scene.sky->direction_to_sun,
                .irradiance = sun_light(*scene.sky).intensity};
    const auto sun = std::ranges::find_if(scene.lights, shines);
    if (sun == scene.lights.end()) return {};
    return {.direction_to_sun = -sun->direction, .irradiance = sun->intensity};
}

Result<scene::Camera> choose_camera(const Options& options, const scene::Scene& scene) {
    if (const auto* given = std::get_if<scene::Camera>(&options.camera)) {
        scene::Camera camera = *given;
        set_planes(camera, world_bounds(scene));
        return camera;
    }
    const auto* name = std::get_if<std::string>(&options.camera);
    if (!name) return default_camera(scene);

    const auto& cameras = scene.cameras;
    if (const auto found = std::ranges::find(cameras, *name, &scene::Camera::name); found != cameras.end())
        return *found;
    size_t index = 0;
    const auto [end, error] = std::from_chars(name->data(), name->data() + name->size(), index);
    if (error == std::errc() && end == name->data() + name->size() && index < cameras.size())
        return cameras[index];

    std::string known;
    for (size_t i = 0; i < cameras.size(); ++i)
        known += fmt::format("{}{} '{}'", i ? ", " : "its cameras: ", i, scene::printable(cameras[i].name));
    return fail(ErrorKind::invalid_argument, "--camera '" + scene::printable(*name) + "'",
                "the scene has no such camera",
                (known.empty() ? "it has none" : known) + "; or give px,py,pz:tx,ty,tz:FOV");
}

std::vector<std::string> warnings_of(const scene::Scene& scene) {
    std::vector<std::string> lines;
    for (const std::string& line : scene.warnings) lines.push_back(scene::printable(line, 1000));
    const size_t shining = size_t(
        std::ranges::count_if(scene.lights, [](auto& light) { return light.intensity != glm::vec3(0); }));
    if (const size_t drawn = shadow::drawn_lights(scene.lights).size(); drawn < shining)
        lines.push_back(
            fmt::format("{} of its {} lights are drawn: at most {} lights with {} shadow maps are (a point "
                        "light has six)",
                        drawn, shining, shadow::max_lights, shadow::max_cameras));
    return lines;
}

}  // namespace lumo::program
