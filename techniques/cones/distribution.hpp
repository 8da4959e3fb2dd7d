// Cones that share out a hemisphere.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace lumo::cones {

inline constexpr int max_cones = 32;

struct Cone {
    glm::vec3 direction{0, 0, 1};  ///< unit length, about +z
    float weight = 1;              ///< share of the irradiance of a constant environment; all add to 1
};

struct Distribution {
    std::vector<Cone> cones;
    /// Radians, of the packed circles: they touch, do not overlap and stay above the horizon. Cones are traced this
    /// wide: wider ones would meet the surface that they start from. At most 75 degrees, which only one cone reaches.
    float half_angle = 0;
};

/// `count` cones, 1 to max_cones, on concentric rings: equal circles packed on the hemisphere after Appelbaum
/// & Weiss (1999), as wide as they fit. A ring's cones share its zone's part of the cosine, which is sin²
/// between the polar angles that bound it, so a constant environment gives exactly its irradiance.
Distribution distribute(int count);

}  // namespace lumo::cones
