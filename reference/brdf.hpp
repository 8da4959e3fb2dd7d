// The reflection of lumo's surfaces, as shaders/common/brdf.glsl has it, and directions drawn after it. All
// directions are unit vectors away from the surface in its own frame, whose +z is the shading normal.
#pragma once

#include <glm/glm.hpp>

namespace lumo::reference {

struct Brdf {
    glm::dvec3 diffuse{0};   ///< base colour of the non-metal part
    glm::dvec3 specular{0};  ///< reflectance at normal incidence
    double roughness = 1;    ///< perceptual; alpha = roughness²
    bool lambert = true;     ///< diffuse / pi and nothing else
};

/// Of glTF's metallic-roughness model.
Brdf make_brdf(glm::dvec3 base_color, double metallic, double roughness);
Brdf lambertian(glm::dvec3 albedo);

/// What leaves toward the eye of the light from a direction, times the cosine of the light; 1/sr. 0 from below. An
/// eye below the shading normal's horizon, which normal maps make possible, is taken as grazing.
struct Reflected {
    glm::dvec3 diffuse{0};   ///< Burley 2012, or Lambert
    glm::dvec3 specular{0};  ///< Karis 2013
};
Reflected reflect(const Brdf& brdf, glm::dvec3 to_eye, glm::dvec3 to_light);

/// Draws directions of light, some by the cosine, the others by the normals of GGX that the eye sees (Heitz 2018,
/// Sampling the GGX Distribution of Visible Normals).
class DirectionSampler {
  public:
    /// `specular_share` of the directions are drawn after the specular lobe; 0 where there is none.
    DirectionSampler(const Brdf& brdf, glm::dvec3 to_eye, double specular_share);

    /// May be below the horizon, where the density is not that of `density`, and nothing is reflected.
    glm::dvec3 draw(double lobe, glm::dvec2 u) const;

    /// Per steradian; 0 below the horizon.
    double density(glm::dvec3 to_light) const;

  private:
    glm::dvec3 to_eye_;
    double alpha_;
    double specular_share_;
};

/// A share of directions for the specular lobe by what both lobes reflect.
double specular_share(const Brdf& brdf, glm::dvec3 to_eye);

}  // namespace lumo::reference
