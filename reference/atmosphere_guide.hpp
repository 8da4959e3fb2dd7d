// Where in the sky light comes from, roughly: what paths are guided by.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "reference/atmosphere_comb.hpp"

namespace lumo::reference {

/// Radiance by altitude, sun and direction in a coarse grid: order 1 by a comb for each direction, and what isotropic
/// scattering and the ground make of that. Directions have densities in proportion to it, the mean over wavelengths of
/// such that each integrate to 1, constant in cells that are crowded at the horizon and at the sun's azimuth.
class LightGuide {
  public:
    LightGuide(const AtmosphereOptics& optics, const ColumnTable& columns);

    /// Directions at a point of the air, in the frame whose z is the vertical and in whose x-z half plane the sun is.
    class Lobe {
      public:
        glm::dvec3 sample(glm::dvec2 u) const;
        double density(glm::dvec3 direction) const;  ///< per steradian

      private:
        friend LightGuide;
        const double* by_zenith;   ///< of a cell of the grid: sums up to and with each zenith's
        const double* by_azimuth;  ///< and of each zenith's, up to and with each azimuth's
        double horizon_mu;
    };
    Lobe lobe(double h, double mu_sun) const;

    /// Radiance from everywhere, integrated over the sphere.
    class Arriving {
      public:
        double operator()(size_t wavelength) const;

      private:
        friend LightGuide;
        const double* low;   ///< of four cells of the grid, the one with the lowest altitude and sun
        const double* high;  ///< its neighbour in altitude
        double along_sun, along_altitude;
        size_t wavelengths;
    };
    Arriving arriving(double h, double mu_sun) const;

  private:
    static constexpr size_t altitudes = 14, suns = 44, below = 6, above = 10, zeniths = below + above,
                            azimuths = 8;
    static constexpr double lowest_sun = -0.6;  ///< a cosine's root, with its sign

    struct Place {
        double altitude = 0, sun = 0;  ///< in steps of the grid
    };
    Place place(double h, double mu_sun) const;
    double altitude(size_t index) const;
    static double sun(size_t index);
    static double edge(double horizon_mu,
                       double zenith);  ///< the cosine at a number of cells from straight down

    const AtmosphereOptics& optics_;
    std::vector<double> arriving_, by_zenith_, by_azimuth_;
};

}  // namespace lumo::reference
