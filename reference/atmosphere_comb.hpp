// What sunlight does along a ray, at points in a fixed pattern with a random offset.
#pragma once

#include <limits>
#include <vector>

#include "reference/atmosphere_columns.hpp"

namespace lumo::reference {

/// A ray by where it starts, at or above the ground.
struct SunnyRay {
    RayPoint start = {};
    double mu_sun = 0;  ///< cosine between vertical and sun, at the start
    double nu = 0;      ///< cosine between ray and sun
    double longest_km = std::numeric_limits<double>::infinity();
    bool from_ground = false;  ///< rounding must not send it into the ground
};

/// Points of a ray, one in each of `teeth` intervals and all at the same place in theirs: with the place uniform in
/// (0, 1), the sum over the points of width · f is an estimate of the integral of f over the part of the ray in the air
/// that has no bias, however few there are. Intervals are crowded toward the lowest point of the ray. An object is
/// marched again and again, so that its memory is reused.
class Comb {
  public:
    static constexpr size_t teeth = 12;

    struct Tooth {
        double width = 0;     ///< km
        double distance = 0;  ///< from the start of the ray, km
        double h = 0;
        double mu_sun = 0;
        Densities density = {};
    };

    /// Keeps references.
    Comb(const AtmosphereOptics& optics, const ColumnTable& columns);

    /// `place` within (0, 1). False where the ray has no air.
    bool march(const SunnyRay& ray, double place);

    const Tooth& tooth(size_t k) const { return tooth_[k]; }
    /// From the start to a tooth.
    double transmittance(size_t k, size_t wavelength) const { return transmittance_[k * size_ + wavelength]; }
    /// Irradiance on a plane that faces the sun.
    double sun(size_t k, size_t wavelength) const { return sun_[k * size_ + wavelength]; }

    /// Where the ray ends at the ground, that is the tooth after the last, whose sun() is on a level plane.
    bool reaches_ground() const { return ground_; }

  private:
    void see(size_t k, const Densities& column, double factor);

    const AtmosphereOptics& optics_;
    const ColumnTable& columns_;
    size_t size_;
    bool ground_ = false;
    std::vector<Tooth> tooth_;
    std::vector<double> transmittance_, sun_;
};

}  // namespace lumo::reference
