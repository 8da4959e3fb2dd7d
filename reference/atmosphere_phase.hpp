// Directions in the air: their densities, and how they are drawn.
#pragma once

#include <glm/glm.hpp>

#include "reference/atmosphere_optics.hpp"

namespace lumo::reference {

/// In the frame whose z is the vertical at the camera and in whose x-z half plane the sun is.
glm::dvec3 sky_direction(double zenith_deg, double azimuth_deg);

/// Per steradian and km: what air of these densities makes of light that it turns by the angle of cosine nu.
double phase_times_scattering(const AtmosphereOptics& optics, const Densities& densities, double nu,
                              size_t wavelength);

/// At an angle of this cosine from a unit vector, u of a turn around it.
glm::dvec3 turned(glm::dvec3 axis, double cosine, double u);

/// Per steradian.
double henyey_greenstein(double nu, double g);
/// Cosines by the phase functions, u within (0, 1).
double sample_henyey_greenstein(double g, double u);
double sample_rayleigh(double u);

}  // namespace lumo::reference
