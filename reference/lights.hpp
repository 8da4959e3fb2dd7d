// Where light starts, as a path tracer aims at it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "reference/ray_scene.hpp"
#include "reference/surface.hpp"
#include "scene/scene.hpp"

namespace lumo::reference {

/// Light of an analytic light at a point, unshadowed.
struct Incident {
    glm::dvec3 to_light{0};    ///< unit length
    double distance = 0;       ///< metres; infinite for a directional light
    glm::dvec3 irradiance{0};  ///< on a facing plane, W/m²
};

/// Attenuation by range and cone as KHR_lights_punctual recommends it; none where nothing arrives.
std::optional<Incident> incident(const scene::Light& light, glm::dvec3 position);

/// A point of an emitting triangle.
struct EmitterSample {
    glm::dvec3 position{0};
    glm::dvec3 normal{0};  ///< of the front, unit length
    double lift = 0;       ///< metres that clear the triangle in float
    bool double_sided = false;
    glm::dvec3 radiance{0};  ///< times the opacity
    double density = 0;      ///< per square metre
};

/// All triangles that emit, drawn by their power.
class Emitters {
  public:
    /// `scene` outlives the result.
    explicit Emitters(const scene::Scene& scene);

    bool empty() const { return triangles_.empty(); }

    EmitterSample sample(double which, glm::dvec2 u) const;

    /// The density per square metre with which `sample` draws a point of a triangle; 0 for one that does not emit.
    double density(const Hit& hit) const;

  private:
    struct Triangle {
        Hit hit;  ///< without weights
        WorldTriangle world;
        bool double_sided;

        double area() const { return 0.5 * glm::length(world.normal); }
    };
    double probability(size_t triangle) const;

    const scene::Scene* scene_;
    std::vector<Triangle> triangles_;
    std::vector<double> cumulative_;  ///< of power, the last is 1
    /// By instance and primitive where its triangles begin in triangles_, if they emit.
    std::vector<std::vector<std::optional<size_t>>> first_;
};

}  // namespace lumo::reference
