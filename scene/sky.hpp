// The sky of a scene: an atmosphere around it, and the sun as it shines through.
//
// The planet's ground passes through the world's origin, less the sky's altitude; its vertical there is +Y, and a unit
// of the world is a metre.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/atmosphere.hpp"
#include "scene/scene.hpp"

namespace lumo::scene {

/// Linear Rec. 709 of a spectral value, by wavelength: rgb = Σ weight · value, W/m²/sr of W/m²/sr/nm. Their luminance is
/// the photometric one over 683 lm/W. Between its wavelengths a spectrum over that of a black body of 5772 K, the sun's
/// temperature, is taken as linear, beyond them as constant; it is weighted by the CIE 1931 2° observer as Wyman, Sloan
/// and Shirley 2013 fit it (Simple Analytic Approximations to the CIE XYZ Color Matching Functions). Colours outside the
/// gamut come out with negative channels.
std::vector<glm::dvec3> rgb_weights(const Spectrum& wavelengths_nm);

/// Σ weight · value, channels below 0 as 0.
glm::dvec3 to_rgb(const std::vector<glm::dvec3>& weights, const Spectrum& spectrum);

/// What gets through the air from the sun to a point, 0 to 1: the transmittance along a ray whose angle to the vertical
/// has the cosine `mu`, times the visible part of the disc, by a smoothstep in the cosine over plus and minus angular
/// radius · ground radius / distance from the centre about the geometric horizon. Within 1e-5.
Spectrum sun_transmittance(const Atmosphere& atmosphere, double altitude_km, double mu);

/// The sun at the world's origin as a directional light; intensity 0 where it is below the horizon.
Light sun_light(const Sky& sky);

/// Luminous irradiance over 683 lm/W at the world's origin, W/m².
struct Daylight {
    double sun = 0;  ///< on a plane that faces it
    double sky =
        0;  ///< on a level plane: of light that the air scattered once, at most 2.5 times less than all
};
/// For exposures.
Daylight daylight(const Sky& sky);

/// Gives the scene this sky, with its sun in place of all directional lights and of the constant environment.
void set_sky(Scene& scene, Sky sky);

}  // namespace lumo::scene
