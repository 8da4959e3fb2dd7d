// Solid geometry for the built-in scenes. Everything made here has unit outward normals, counter-clockwise
// fronts, no triangle without area, uv0 in metres along the surface (u along the tangent, v downward) until a
// Finish says how many metres a texture covers, and tangents by glTF's rule (the bitangent points to -v).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.hpp"

namespace lumo::scene::builtin {

struct Geometry {
    std::vector<Vertex> vertices;
    std::vector<uint32_t> indices;  ///< three a triangle
};

/// A material and how its textures are laid on geometry.
struct Finish {
    uint32_t material = 0;      ///< index into Scene::materials
    float metres_per_tile = 1;  ///< what one repetition of its textures covers

    bool operator==(const Finish&) const = default;
};

/// Geometry of several finishes that is placed as one.
class Model {
  public:
    /// The geometry of a finish, empty at first. The reference holds until the next call.
    Geometry& operator[](const Finish& finish);

    std::span<const std::pair<Finish, Geometry>> parts() const { return parts_; }

  private:
    std::vector<std::pair<Finish, Geometry>> parts_;
};

/// Adds a copy placed by an affine matrix; a mirroring one keeps fronts in front.
void append(Geometry& to, const Geometry& from, const glm::mat4& placement = glm::mat4(1));
void append(Model& to, const Model& from, const glm::mat4& placement = glm::mat4(1));

/// The same surface with its front on the other side.
Geometry reversed(Geometry geometry);

/// Adds the model as a mesh. Returns its index into Scene::meshes.
uint32_t add_mesh(Scene& scene, std::string name, const Model& model);

/// Adds an untextured diffuse material of that linear albedo. Returns its index.
uint32_t add_diffuse_material(Scene& scene, std::string name, glm::vec3 albedo);

glm::mat4 translation(glm::vec3 offset);
glm::mat4 rotation_y(float radians);  ///< takes +Z toward +X

/// A parallelogram seen from cross(right, up), with right and up as its edges from origin.
Geometry parallelogram(glm::vec3 origin, glm::vec3 right, glm::vec3 up);

/// A flat or nearly flat polygon of four corners, counter-clockwise, with one normal; u runs from a to b.
Geometry quadrilateral(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);

/// An axis-aligned closed box; uv0 is a projection of the position, so that patterns go on from box to box.
Geometry box(glm::vec3 min, glm::vec3 max);

/// A closed block of flat faces between a lower and an upper one, both counter-clockwise seen from above.
Geometry block(const std::array<glm::vec3, 4>& lower, const std::array<glm::vec3, 4>& upper);

struct GridShape {
    uint32_t columns = 1;  ///< quads along s
    uint32_t rows = 1;     ///< quads along t
    glm::vec2 metres{1};   ///< what uv0 spans
};

/// The surface position(s, t) over [0,1]², with t upward where s goes right as seen from the front. An edge may
/// shrink to a point. Normals come from the positions by differences.
Geometry grid(const GridShape& shape, const std::function<glm::vec3(float s, float t)>& position);

/// A cross-section: points (x outward, y along the surface's up), the front to the right of the way along it,
/// so that a wall is listed from its foot up. Corners sharper than crease_angle stay sharp.
struct Profile {
    std::vector<glm::vec2> points;
    float crease_angle = 0.7f;  ///< radians
};

/// An arc as profile points, both ends included, angles in radians from +x toward +y.
std::vector<glm::vec2> arc(glm::vec2 center, glm::vec2 radii, float from, float to, uint32_t segments);

/// Where a swept profile stands: origin + x x_axis + y y_axis + x shear along, where along = y_axis × x_axis is
/// the way of the path.
struct SweepFrame {
    glm::vec3 origin{0};
    glm::vec3 x_axis{0, 0, 1};  ///< unit
    glm::vec3 y_axis{0, 1, 0};  ///< unit, perpendicular to x_axis
    float u = 0;                ///< metres along the path
    float shear = 0;            ///< for mitres
};

/// A profile carried from frame to frame.
Geometry sweep(const Profile& profile, std::span<const SweepFrame> frames);

/// A profile turned about +Y, x being the radius; closed where the profile begins and ends on the axis.
Geometry lathe(const Profile& profile, uint32_t segments);

/// A profile carried round a regular polygon about +Y with mitred corners, x being the apothem; one face looks to
/// +Z.
Geometry prism(const Profile& profile, uint32_t sides);

/// A profile carried along +X from 0 to length, facing +Z. A mitre of 1 shortens that end by the profile's x
/// (an inner corner of a room), -1 lengthens it (an outer corner), 0 cuts it square.
Geometry moulding(const Profile& profile, float length, float mitre_start = 0, float mitre_end = 0);

/// A profile carried along an arch in the XY plane from the left springing over the crown to the right one,
/// about the origin: profile x is +Z, profile y is added to the radii.
Geometry archivolt(const Profile& profile, glm::vec2 radii, uint32_t segments);

/// A sphere about the origin as a closed polyhedron with faces as normals.
Geometry faceted_sphere(float radius, uint32_t segments, uint32_t rings);

/// A smooth sphere about the origin.
Geometry sphere(float radius, uint32_t segments, uint32_t rings);

}  // namespace lumo::scene::builtin
