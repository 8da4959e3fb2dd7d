// The sky as the path tracer takes it.
#pragma once

#include "samples/lumo/options.hpp"
#include "scene/scene.hpp"

namespace lumo::program {

/// Gives a scene that has a sky its Scene::environment_map, from the tables that frames are made of, by the first API
/// that works; no other scene needs a device. So the path tracer's light is the frame's to the map's half a degree,
/// without the sun's disc, and what is between their pictures is not the sky. Errors: those of open_devices and of sky::Sky.
Result<void> add_sky_map(scene::Scene& scene, const Options& options);

}  // namespace lumo::program
