// Tangents for normal maps by MikkTSpace's rules, which glTF prescribes where a file gives none.
//
// Source: M. S. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", master's thesis, University of
// Copenhagen, 2008, and the rules published with it (mikktspace.com): vertices of equal position, normal and
// uv are one; the triangles around it form groups of equal uv orientation that hang together by edges; a
// group's tangent is the sum of its triangles' uv gradients, projected on the normal's plane and weighted by
// the angle at the vertex. Of the rules only the angular threshold is left out: its default, 180 degrees,
// separates nothing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace lumo::scene {

/// Which texture coordinates a normal map is read with.
struct TangentUv {
    uint32_t uv_set = 0;  ///< 0 or 1
    glm::mat3 uv_transform{1};
};

/// The tangent of each corner of a triangle list, as in Vertex::tangent. indices.size() is a multiple of 3,
/// every index below vertices.size(), normals are of unit length. Where the texture coordinates give no
/// direction, it is any one in the normal's plane.
std::vector<glm::vec4> corner_tangents(std::span<const Vertex> vertices, std::span<const uint32_t> indices,
                                       const TangentUv& uv = {});

/// Sets the tangents of a triangle list, whose preconditions are those of corner_tangents. Vertices where
/// differing tangents meet are split; vertices that no triangle uses are dropped.
void generate_tangents(std::vector<Vertex>& vertices, std::vector<uint32_t>& indices,
                       const TangentUv& uv = {});

}  // namespace lumo::scene
