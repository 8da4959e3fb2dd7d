// What a ray's hit is made of: the geometry and the material of a point on a triangle, as the shaders have it
// (shaders/common/material.glsl, shaders/gbuffer), with textures at full resolution.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "reference/brdf.hpp"
#include "reference/ray_scene.hpp"
#include "scene/scene.hpp"

namespace lumo::reference {

/// Coverage at a point of a triangle: 0 or 1 for MASK, opacity for BLEND, else 1. `weights` as in Hit.
double opacity_at(const scene::Scene& scene, const scene::Primitive& primitive, uint32_t triangle,
                  glm::dvec2 weights);

/// A triangle in world space.
struct WorldTriangle {
    std::array<glm::dvec3, 3> corners;  ///< in the order of its indices
    glm::dvec3 normal{0};               ///< of the front; its length is twice the area, m²

    /// The distance along the normal, in metres, at which rays in float may start and end without meeting it.
    double lift() const;
};
WorldTriangle world_triangle(const scene::Scene& scene, const Hit& hit);

/// Radiance that the front of a surface, or any side of a double-sided one, sends out; W/m²/sr.
glm::dvec3 emission_at(const scene::Scene& scene, const Hit& hit);

/// A point of a surface seen from one side; the vectors are in world space.
struct SurfacePoint {
    glm::dvec3 position{0};
    glm::dvec3 geometric_normal{0};  ///< of the triangle, unit length, on the viewer's side
    glm::dvec3 normal{0};  ///< for shading, unit length; on the same side as the vertex normals then are
    double lift = 0;       ///< metres along the geometric normal that clear the triangle in float
    bool front = true;
    bool unlit = false;
    glm::dvec3 base_color{0};
    glm::dvec3 emission{0};  ///< toward the viewer, W/m²/sr
    Brdf brdf = {};

    /// A start for rays to the viewer's side.
    glm::dvec3 above() const { return position + lift * geometric_normal; }
};

/// `direction` is the ray's. With `diffuse` the material is Lambertian in its base colour, without normal map, metal
/// and roughness.
SurfacePoint surface_at(const scene::Scene& scene, const Hit& hit, glm::dvec3 direction, bool diffuse);

}  // namespace lumo::reference
