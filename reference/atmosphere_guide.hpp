// Where in the sky light comes from, roughly: what paths are guided by.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "reference/atmosphere_comb.hpp"

namespace lumo::reference {

/// Radiance by altitude, sun and direction in a coarse grid: order 1 by a comb for each direction, and what isotropic
/// scattering and the ground make of that. Directions have densities in proportion to it, the mean over wavelengths of
/// such that each integrate to 1, constant in cells that are crowded at the horizon and at the sun's azimuth.
class LightGuide {
    static constexpr size_t altitudes = 14, suns = 44, below = 6, above = 10, zeniths = below + above,
                            azimuths = 8;
    static constexpr double lowest_sun = -0.6;  ///< a cosine's root, with its sign

  public:
    LightGuide(const AtmosphereOptics& optics, const ColumnTable& columns);

    /// Directions at a point, in the frame whose z is the vertical and in whose x-z half plane the sun is.
    class Lobe {
      public:
        glm::dvec3 sample(glm::dvec2 u) const;
        double density(glm::dvec3 direction) const;  ///< per steradian

      private:
        friend LightGuide;
        static constexpr size_t sides = 2;  ///< of the plane of the sun
        double horizon_mu = 0;
        std::array<double, zeniths> by_zenith = {};                    ///< sums up to and with each zenith's
        std::array<double, zeniths* azimuths* sides> by_azimuth = {};  ///< of each zenith's, from -pi to pi
    };
    Lobe lobe(double h, double mu_sun) const;
    /// Times what air makes of light that it turns into `along`, in that frame: the mean of phase functions, `by_mie` of
    /// it the aerosols'.
    Lobe lobe(double h, double mu_sun, glm::dvec3 along, double by_mie) const;

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
    struct Place {
        double altitude = 0, sun = 0;  ///< in steps of the grid
    };
    Place place(double h, double mu_sun) const;
    double altitude(size_t index) const;
    static double sun(size_t index);
    /// The cosine at a number of cells from straight down.
    static double edge(double horizon_mu, double zenith);
    static double azimuth_edge(size_t azimuth);
    template <class F>
    Lobe weighted(double h, double mu_sun, const F& weight) const;

    const AtmosphereOptics& optics_;
    std::array<glm::dvec2, azimuths> level_ = {};  ///< cosine and sine of each cell's azimuth
    std::vector<double> arriving_;
    std::vector<double> light_;  ///< of each direction's cell, a part of 1
};

}  // namespace lumo::reference
