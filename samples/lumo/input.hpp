// What a frame is made of, as the command line chose it.
#pragma once

#include <string>
#include <vector>

#include "rhi/error.hpp"
#include "samples/lumo/options.hpp"
#include "scene/scene.hpp"

namespace lumo::program {

/// The scene that the options name, under the sun or the sky that they ask for; a scene that nothing lights
/// gets one, and a warning. Errors: those of load_gltf and
/// make_builtin.
Result<scene::Scene> load_scene(const Options& options);

/// Puts a sun in place of all directional lights; under a sky its direction alone counts.
void replace_sun(scene::Scene& scene, const Sun& sun);

/// A scene's sun, that of its sky, which the horizon may hide, or its first directional light with any intensity; none: irradiance 0.
Sun sun_of(const scene::Scene& scene);

/// The camera that the options name. Errors: invalid_argument with the cameras that there are.
Result<scene::Camera> choose_camera(const Options& options, const scene::Scene& scene);

/// All that a picture of the scene will not show as the scene has it, a line each.
std::vector<std::string> warnings_of(const scene::Scene& scene);

}  // namespace lumo::program
