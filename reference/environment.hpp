// Light from beyond a scene's geometry, as a path tracer aims at it.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.hpp"

namespace lumo::reference {

struct EnvironmentSample {
    glm::dvec3 direction{0};
    double density = 0;  ///< per steradian
};

class Environment {
  public:
    /// Scene::environment_radiance and environment_map. `scene` outlives the result.
    explicit Environment(const scene::Scene& scene);

    /// W/m²/sr from a direction; the map is filtered linearly.
    glm::dvec3 radiance(glm::dvec3 direction) const;

    /// Without a map there is nothing to aim at.
    bool uniform() const { return columns_ == 0; }
    /// A direction by the map's radiance; not uniform().
    EnvironmentSample sample(glm::dvec2 u) const;
    /// Per steradian, of sample(); 0 where uniform().
    double density(glm::dvec3 direction) const;

  private:
    double solid_angle(size_t row) const;

    const scene::Scene* scene_;
    size_t columns_ = 0, rows_ = 0;
    std::vector<double> cumulative_;  ///< of the texels' shares by rows, the last is 1
};

}  // namespace lumo::reference
