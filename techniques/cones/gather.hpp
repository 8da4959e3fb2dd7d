// What shaders/cones/gather.glsl reads.
#pragma once

#include <glm/glm.hpp>

#include "shaders/cones/irradiance.hpp"
#include "techniques/cones/distribution.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::cones {

/// The uniform block of every program that gathers.
using GatherBlock = shaders::cones::irradiance::Gather;

/// `environment` is the radiance from outside the grid, W/m²/sr.
GatherBlock gather_block(const Distribution& distribution, const voxels::View& volume, glm::vec3 environment);

}  // namespace lumo::cones
