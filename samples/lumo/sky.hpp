// The sky of a scene, before frames are made of it.
#pragma once

#include <memory>
#include <vector>

#include "rhi/rhi.hpp"
#include "samples/lumo/options.hpp"
#include "scene/scene.hpp"

namespace lumo::program {

/// The tables of the scene's sky, if it has one, as sky::Settings::made takes them for frames on this device: from the
/// user's cache, or computed, while a bar shows how far they are. Errors: those of sky::Sky.
Result<std::shared_ptr<const std::vector<atmosphere::Tables>>> sky_tables(rhi::Device& device,
                                                                          const scene::Scene& scene,
                                                                          const Options& options);

/// Gives a scene that has a sky its Scene::environment_map, from the tables that frames are made of, by the first API
/// that works; no other scene needs a device. So the path tracer's light is the frame's to the map's half a degree,
/// without the sun's disc, and what is between their pictures is not the sky. Errors: those of open_devices and of sky::Sky.
Result<void> add_sky_map(scene::Scene& scene, const Options& options);

}  // namespace lumo::program
