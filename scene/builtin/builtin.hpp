// Scenes made by code: always there, the same bits on every run.
#pragma once

#include <span>
#include <string_view>

#include "rhi/error.hpp"
#include "scene/scene.hpp"

namespace lumo::scene {

/// The names that make_builtin knows, the default scene first:
///  - atrium           a colonnaded court with coloured cloth under sun and sky; textured, no emitters; cameras
///                     court, gallery, balcony and fountain
///  - cornell          the Cornell box as measured at Cornell University, at ten times its size
///  - area-light       the paper's HDR case: a red and a green wall lit by a sphere that emits (0, 0, 10)
///  - area-light-pure  the same with wall albedos of exactly (1, 0, 0) and (0, 1, 0): physics leaves both walls
///                     black and all red and green radiance zero; what appears there has leaked
///  - furnace          a closed convex body of albedo 1 in an environment of radiance 1: irradiance is pi and
///                     radiance 1 at every point and for every number of bounces
///  - sky              things on a paved place under Earth's sky, the sun 33 degrees high; cameras ground, air (10 km) and
///                     orbit (400 km)
std::span<const std::string_view> builtin_names();

/// The scene of that name. Errors: invalid_argument for an unknown name.
Result<Scene> make_builtin(std::string_view name);

}  // namespace lumo::scene
