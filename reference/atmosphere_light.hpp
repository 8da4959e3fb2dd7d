// Light in an atmosphere, in double precision: order 1 by converged quadrature, higher orders by Monte Carlo.
//
// Light is scalar and travels straight. A scattering by the air counts as an order, and so does a reflection by the
// ground; the last event before the eye is a scattering by the air, so that light which leaves the ground straight for
// the camera is in none of these. The sun is a point, faded by AtmosphereOptics::sun_visibility. Altitudes are 0 and
// up, also above the air.
#pragma once

#include <cstdint>
#include <limits>

#include "reference/atmosphere_optics.hpp"

namespace lumo::reference {

/// A camera, where it looks, and the sun, as angles at the camera.
struct SkyView {
    double altitude_km = 0;
    double view_zenith_deg = 0;  ///< 0 to 180, from the local vertical
    double sun_zenith_deg = 0;   ///< 0 to 180
    double azimuth_deg = 0;      ///< of the view, 0 toward the sun
    /// Light that is scattered farther from the camera is left out.
    double distance_km = std::numeric_limits<double>::infinity();
};

/// Radiance of order 1, W/m²/sr/nm: the integral along the view ray over transmittance · scattering · phase · sun
/// (Bruneton and Neyret 2008, section 2.2, with the sun as the only light). `tolerance` is the relative error aimed at.
Spectrum radiance_order1(const AtmosphereOptics& optics, const SkyView& view, double tolerance = 1e-7);

/// Which events a Monte Carlo estimate counts, and how well.
struct PathSettings {
    uint32_t first_order = 2;
    uint32_t last_order = 4;  ///< all_orders: paths are ended by Russian roulette alone
    uint32_t samples = 10'000;
    uint64_t seed = 1;  ///< the same seed, the same result
};
inline constexpr uint32_t all_orders = std::numeric_limits<uint32_t>::max();

/// A mean over samples and its standard error; the same paths serve every wavelength.
struct Estimate {
    Spectrum mean;
    Spectrum error;
};

/// Radiance of the orders asked for, W/m²/sr/nm, by paths that know little of where light is; GuidedPaths is quicker, and
/// held against this.
Estimate radiance(const AtmosphereOptics& optics, const SkyView& view, const PathSettings& settings);

/// Irradiance of the sky on a horizontal plane that faces up, W/m²/nm, of the orders asked for (from 1 on for all of
/// it); the view's direction and distance say nothing.
Estimate sky_irradiance(const AtmosphereOptics& optics, const SkyView& view, const PathSettings& settings);

}  // namespace lumo::reference
