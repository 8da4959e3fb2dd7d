// Textures made by formula: tileable, the same bits on every run.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace lumo::scene::builtin {

/// What a surface is at one point.
struct SurfaceSample {
    glm::vec3 albedo{0.5f};  ///< linear
    float height = 0;        ///< metres, outward
    float roughness = 1;     ///< perceptual
};

/// A surface over one tile: position in [0,1)², x to the right, y up. It goes on seamlessly at the tile's
/// edges.
using SurfacePattern = SurfaceSample (*)(glm::vec2 position);

SurfaceSample limestone(glm::vec2 position);  ///< fine smooth stone of columns and mouldings; made for 2 m
SurfaceSample ashlar(glm::vec2 position);     ///< four courses of squared blocks; made for 2.24 m
SurfaceSample plaster(glm::vec2 position);    ///< trowelled, stained; made for 3 m
SurfaceSample marble(glm::vec2 position);     ///< white with grey veins; made for 1.5 m
SurfaceSample inlay(
    glm::vec2 position);  ///< a paving of marbles, one square field with its bands; made for 2.8 m
SurfaceSample brick_floor(glm::vec2 position);  ///< terracotta in herringbone; made for 1.12 m
SurfaceSample clay(glm::vec2 position);         ///< terracotta of pots and tiles; made for 1 m
SurfaceSample planks(glm::vec2 position);       ///< four boards, grain along y; made for 1 m
SurfaceSample damask(
    glm::vec2 position);  ///< woven cloth with a figure, near white for tinting; made for 0.7 m

/// Adds base colour, roughness and normal images of side² pixels and a material that uses them. Albedo is
/// multiplied by tint. Returns the material's index.
struct SurfaceMaterial {
    const char* name;
    SurfacePattern pattern;
    float metres_per_tile;
    uint32_t side = 512;
};
uint32_t add_surface_material(Scene& scene, const SurfaceMaterial& surface);

/// Adds a material that shares another's textures under another tint. Returns its index.
uint32_t add_tinted_material(Scene& scene, const char* name, uint32_t like, glm::vec3 tint);

}  // namespace lumo::scene::builtin
