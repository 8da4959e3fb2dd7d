// Optical depths along rays through an atmosphere, in double precision: exact for ozone, to about 1e-9 for the rest.
//
// Points are given by altitude, never by radius, so that nothing cancels near the ground: with R the ground's radius,
// r = R + h, a ray from h with the cosine mu of its angle to the vertical has at distance d the altitude
//   h + (d² + 2 r mu d) / (r + r(d)),   r(d)² = r² + 2 r mu d + d².
// Lengths are in km.
#pragma once

#include <array>
#include <optional>

#include "scene/atmosphere.hpp"

namespace lumo::reference {

using scene::Atmosphere;
using scene::Spectrum;

/// A point of a ray: altitude, and the cosine of the angle between the ray's direction and the vertical there.
struct RayPoint {
    double h = 0;
    double mu = 0;
};

/// Densities, or their integrals along a path (km); both relative to the density that the coefficients are for.
struct Densities {
    double rayleigh = 0, mie = 0, ozone = 0;

    Densities& operator+=(const Densities& other);
};

/// The part of a ray that is in the air.
struct AirPath {
    double entry = 0;   ///< distance from the ray's start, 0 if that is in the air
    RayPoint at = {};   ///< there
    double length = 0;  ///< up to the ground or to the top
    bool ground = false;
};

/// Per steradian, integrating to 1 over the sphere; nu is the cosine of the angle between the directions in which light
/// travels before and after.
double rayleigh_phase(double nu);
/// Cornette and Shanks 1992, Physically reasonable analytic expression for the single-scattering phase function,
/// as Bruneton and Neyret 2008 have it in section 2.1.
double cornette_shanks_phase(double nu, double g);

/// Exact to the last place at multiples of 90 degrees.
double cos_degrees(double degrees);

class AtmosphereOptics {
  public:
    /// `atmosphere` has passed check().
    explicit AtmosphereOptics(Atmosphere atmosphere);

    const Atmosphere& atmosphere() const { return a_; }
    size_t wavelengths() const { return a_.wavelengths_nm.size(); }
    double radius(double h) const { return a_.radius_ground_km + h; }

    /// Where a ray comes to after a distance.
    RayPoint along(RayPoint from, double distance) const;
    /// None where the ray never meets air. A ray that touches the ground does not end there.
    std::optional<AirPath> air_path(RayPoint from) const;
    /// The cosine of the angle between the vertical and the geometric horizon, 0 or less.
    double horizon_mu(double h) const;

    Densities densities(double h) const;
    /// Along a path in the air that does not pass below the ground.
    Densities column(RayPoint from, double length) const;
    double extinction(const Densities& densities, size_t wavelength) const;
    double scattering(const Densities& densities, size_t wavelength) const;
    /// exp(-extinction) of a column.
    Spectrum transmittance(const Densities& column) const;

    /// Of all of a ray from anywhere at or above the ground; 0 where it ends at the ground.
    Spectrum transmittance_to_space(RayPoint from) const;
    /// Over a distance; 0 where the ground lies between.
    Spectrum transmittance_segment(RayPoint from, double distance) const;

    /// The part of the sun's disc above the geometric horizon, by a smoothstep in the cosine over plus and minus
    /// angular radius · R / r (Bruneton 2017, GetTransmittanceToSun).
    double sun_visibility(double h, double mu_sun) const;
    /// From a point of the air to the sun. Below the horizon it is that of the horizon: the air that the visible part
    /// of the disc shines through.
    Densities sun_column(double h, double mu_sun) const;
    /// On a horizontal plane, of the point-like sun: irradiance · transmittance · visibility · max(mu, 0), W/m²/nm.
    Spectrum sun_irradiance(double h, double mu_sun) const;

    /// Altitudes at which a density bends, or has fallen by a power of e; ascending, within the air.
    const std::vector<double>& borders() const { return borders_; }

  private:
    double to_altitude(RayPoint from, double h) const;
    Densities upward(RayPoint low, double length) const;
    double exponential(RayPoint low, double length, double scale_height) const;
    double ozone(RayPoint low, double length) const;

    Atmosphere a_;
    std::vector<double> borders_;
};

/// Gauss-Legendre with 8 nodes on [-1, 1], the positive half; exact for polynomials of degree 15.
inline constexpr std::array<double, 4> gauss_nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                   0.9602898564975363};
inline constexpr std::array<double, 4> gauss_weights{0.3626837833783620, 0.3137066458778873,
                                                     0.2223810344533745, 0.1012285362903763};

/// Calls sample(x, weight) for the integral over [from, to].
template <class F>
void gauss(double from, double to, const F& sample) {
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    for (size_t i = 0; i < gauss_nodes.size(); ++i) {
        sample(middle - half * gauss_nodes[i], half * gauss_weights[i]);
        sample(middle + half * gauss_nodes[i], half * gauss_weights[i]);
    }
}

}  // namespace lumo::reference
