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

/// A surface over one tile, seamless at its edges: position in [0,1)², x to the right, y up.
using SurfacePattern = SurfaceSample (*)(glm::vec2 position);

/// Fine smooth stone of columns and mouldings. Made for a tile of 2 m.
SurfaceSample limestone(glm::vec2 position);
/// Four courses of squared blocks. Made for 2.24 m.
SurfaceSample ashlar(glm::vec2 position);
/// Trowelled and stained. Made for 3 m.
SurfaceSample plaster(glm::vec2 position);
/// White with grey veins. Made for 1.5 m.
SurfaceSample marble(glm::vec2 position);
/// A paving of four marbles: a square field within half of the bands it shares with its neighbours. Made for 2.8 m.
SurfaceSample inlay(glm::vec2 position);
/// Terracotta bricks in herringbone. Made for 1.12 m.
SurfaceSample brick_floor(glm::vec2 position);
/// Terracotta of pots and roof tiles. Made for 1 m.
SurfaceSample clay(glm::vec2 position);
/// Four boards with their grain along y. Made for 1 m.
SurfaceSample planks(glm::vec2 position);
/// Woven cloth with a figure, near white for tinting. Made for 0.7 m.
SurfaceSample damask(glm::vec2 position);

struct SurfaceMaterial {
    const char* name;
    SurfacePattern pattern;
    float metres_per_tile;  ///< gives the slopes of the normal map
    uint32_t side = 512;    ///< of the images, pixels
};

/// Adds a dielectric material with its base colour, roughness and normal images. Returns the material's index.
uint32_t add_surface_material(Scene& scene, const SurfaceMaterial& surface);

/// Adds a material that shares another's textures, its albedo multiplied by tint. Returns its index.
uint32_t add_tinted_material(Scene& scene, const char* name, uint32_t like, glm::vec3 tint);

}  // namespace lumo::scene::builtin
