// The sky and the air of a scene as its camera sees them, in double precision and linear Rec. 709: light that was
// scattered once by quadrature, the rest by Monte Carlo.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/atmosphere_light.hpp"
#include "scene/scene.hpp"

namespace lumo::reference {

/// By what the air over a distance changes light: what gets through times `transmittance`, plus `radiance`, W/m²/sr.
struct AirBefore {
    glm::dvec3 radiance{0};
    glm::dvec3 transmittance{1};
};

/// How many paths an estimate has, and which: the same seed, the same result.
struct SeenSkyPaths {
    uint32_t count = 32;
    uint64_t seed = 1;
};

class SeenSky {
  public:
    /// From a place of the world, in metres (scene/sky.hpp). `sky` outlives the result.
    SeenSky(const scene::Sky& sky, glm::dvec3 eye);

    /// Along a direction of unit length, up to a surface `metres` away; the planet's ground lies no nearer than that.
    AirBefore over(glm::dvec3 direction, double metres, const SeenSkyPaths& paths) const;

    /// Along all of the direction: the air's radiance, and the planet's ground behind it, Lambertian and lit by sun and
    /// sky; without the sun's disc.
    glm::dvec3 beyond(glm::dvec3 direction, const SeenSkyPaths& paths) const;

    /// Radians to the edge of the sun's disc, below 0 within it.
    double to_sun_disc(glm::dvec3 direction) const;
    /// Of the sun's disc, in W/m²/sr: its irradiance spread over it as cosine^(-0.023 + 292 nm / wavelength) (Hestroffer
    /// and Magnan 1998, Wavelength dependency of the solar limb darkening), as the air lets it through.
    glm::dvec3 disc(glm::dvec3 direction) const;

  private:
    SkyView view_of(glm::dvec3 direction) const;
    RayPoint start_of(glm::dvec3 direction) const;
    Spectrum scattered(const SkyView& view, const SeenSkyPaths& paths) const;

    const scene::Sky* sky_;
    AtmosphereOptics optics_;
    std::vector<glm::dvec3> weights_;  ///< scene::rgb_weights
    glm::dvec3 sunlight_{0};           ///< above the air
    glm::dvec3 up_{0, 1, 0};
    double altitude_km_ = 0;
};

}  // namespace lumo::reference
