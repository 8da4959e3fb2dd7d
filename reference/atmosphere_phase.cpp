#include "reference/atmosphere_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/sampler.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

glm::dvec3 sky_direction(double zenith_deg, double azimuth_deg) {
    const double sine = cos_degrees(90 - zenith_deg);
    return {sine * cos_degrees(azimuth_deg), sine * cos_degrees(azimuth_deg - 90), cos_degrees(zenith_deg)};
}

double phase_times_scattering(const AtmosphereOptics& optics, const Densities& densities, double nu,
                              size_t i) {
    const Atmosphere& a = optics.atmosphere();
    return (a.rayleigh ? a.rayleigh->scattering_per_km[i] * densities.rayleigh * rayleigh_phase(nu) : 0) +
           (a.mie ? a.mie->scattering_per_km[i] * densities.mie * cornette_shanks_phase(nu, a.mie->g) : 0);
}

glm::dvec3 turned(glm::dvec3 axis, double cosine, double u) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0)), angle = 2 * pi * u;
    return glm::normalize(frame_about(axis) *
                          glm::dvec3(sine * std::cos(angle), sine * std::sin(angle), cosine));
}

double henyey_greenstein(double nu, double g) {
    const double base = 1 + g * g - 2 * g * nu;
    return (1 - g * g) / (4 * pi * base * std::sqrt(base));
}

double sample_henyey_greenstein(double g, double u) {
    if (std::abs(g) < 1e-3) return 1 - 2 * u;
    const double ratio = (1 - g * g) / (1 - g + 2 * g * u);
    return std::clamp((1 + g * g - ratio * ratio) / (2 * g), -1.0, 1.0);
}

/// The inverse of (nu³ + 3 nu + 4) / 8, by Cardano's formula.
double sample_rayleigh(double u) {
    const double z = 4 * u - 2;
    const double root = std::cbrt(z + std::sqrt(z * z + 1));
    return std::clamp(root - 1 / root, -1.0, 1.0);
}

}  // namespace lumo::reference
