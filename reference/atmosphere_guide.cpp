#include "reference/atmosphere_guide.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/atmosphere_phase.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

double sine_of(double cosine) { return std::sqrt(std::max(1 - cosine * cosine, 0.0)); }

/// Makes sums of masses, up to and with each, that end with 1; even ones where all masses are 0.
double accumulate(double* masses, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; ++i) masses[i] = sum += masses[i];
    for (size_t i = 0; i < count; ++i) masses[i] = sum > 0 ? masses[i] / sum : double(i + 1) / double(count);
    masses[count - 1] = 1;
    return sum;
}

/// A cell drawn by such sums, and the place in it, 0 to 1.
double draw(const double* sums, size_t count, double u, size_t& cell) {
    cell = std::min(size_t(std::upper_bound(sums, sums + count, u) - sums), count - 1);
    const double low = cell > 0 ? sums[cell - 1] : 0;
    return std::clamp((u - low) / (sums[cell] - low), 0.0, 1.0);
}

}  // namespace

LightGuide::LightGuide(const AtmosphereOptics& optics, const ColumnTable& columns)
    : optics_(optics),
      arriving_(altitudes * suns * optics.wavelengths()),
      light_(altitudes * suns * zeniths * azimuths) {
    for (size_t k = 0; k < azimuths; ++k) {
        const double phi = pi * std::pow((double(k) + 0.5) / azimuths, 2);
        level_[k] = {std::cos(phi), std::sin(phi)};
    }
    Comb comb(optics, columns);
    const Atmosphere& a = optics.atmosphere();
    const size_t wavelengths = optics.wavelengths();
    // Radiance times solid angle of each cell: of order 1, then with what that is scattered to once more.
    std::vector<double> light(light_.size() * wavelengths);
    for (const bool first : {true, false}) {
        std::vector<double> all(arriving_.size());
        for (size_t cell = 0; cell < altitudes * suns; ++cell) {
            const double h = altitude(cell / suns), mu_sun = sun(cell % suns);
            const double horizon = optics.horizon_mu(h);
            for (size_t ray = 0; ray < zeniths * azimuths; ++ray) {
                const auto zenith = double(ray / azimuths), azimuth = double(ray % azimuths);
                const double low = edge(horizon, zenith), high = edge(horizon, zenith + 1);
                const double mu = 0.5 * (low + high);
                const double nu = mu * mu_sun + sine_of(mu) * sine_of(mu_sun) * level_[ray % azimuths].x;
                const double solid_angle = (high - low) * 2 * pi * (2 * azimuth + 1) / (azimuths * azimuths);
                double* const mass = &light[(cell * zeniths * azimuths + ray) * wavelengths];
                if (comb.march({.start = {h, mu}, .mu_sun = mu_sun, .nu = nu}, 0.5)) {
                    for (size_t k = 0; k < Comb::teeth; ++k) {
                        const Comb::Tooth& at = comb.tooth(k);
                        const Arriving diffuse = arriving(at.h, at.mu_sun);
                        for (size_t i = 0; i < wavelengths; ++i) {
                            const double sent =
                                first ? phase_times_scattering(optics, at.density, nu, i) * comb.sun(k, i)
                                      : optics.scattering(at.density, i) * diffuse(i) / (4 * pi);
                            mass[i] += solid_angle * at.width * comb.transmittance(k, i) * sent;
                        }
                    }
                    if (comb.reaches_ground()) {
                        constexpr size_t ground = Comb::teeth;
                        const Arriving diffuse = arriving(0, comb.tooth(ground).mu_sun);
                        for (size_t i = 0; i < wavelengths; ++i)
                            mass[i] += solid_angle * comb.transmittance(ground, i) * a.ground_albedo[i] / pi *
                                       (first ? comb.sun(ground, i) : diffuse(i) / 4);
                    }
                }
                for (size_t i = 0; i < wavelengths; ++i) all[cell * wavelengths + i] += mass[i];
            }
        }
        arriving_ = all;
    }
    for (size_t ray = 0; ray < light_.size(); ++ray) {
        const double* const all = &arriving_[ray / (zeniths * azimuths) * wavelengths];
        for (size_t i = 0; i < wavelengths; ++i)
            if (all[i] > 0) light_[ray] += light[ray * wavelengths + i] / (all[i] * double(wavelengths));
    }
}

double LightGuide::altitude(size_t index) const {
    return optics_.atmosphere().height_km() * std::pow(double(index) / (altitudes - 1), 2);
}

double LightGuide::sun(size_t index) {
    const double root = std::lerp(lowest_sun, 1.0, double(index) / (suns - 1));
    return root * std::abs(root);
}

LightGuide::Place LightGuide::place(double h, double mu_sun) const {
    const double root = std::copysign(std::sqrt(std::abs(mu_sun)), mu_sun);
    return {
        .altitude = std::sqrt(std::clamp(h / optics_.atmosphere().height_km(), 0.0, 1.0)) * (altitudes - 1),
        .sun = std::clamp((root - lowest_sun) / (1 - lowest_sun), 0.0, 1.0) * (suns - 1)};
}

double LightGuide::edge(double horizon_mu, double zenith) {
    const double t = (zenith - below) / (zenith < below ? below : above);
    return horizon_mu + (t < 0 ? -(horizon_mu + 1) : 1 - horizon_mu) * t * t;
}

LightGuide::Arriving LightGuide::arriving(double h, double mu_sun) const {
    const Place at = place(h, mu_sun);
    const size_t i = std::min(size_t(at.altitude), altitudes - 2), k = std::min(size_t(at.sun), suns - 2);
    Arriving arriving;
    arriving.wavelengths = optics_.wavelengths();
    arriving.low = &arriving_[(i * suns + k) * arriving.wavelengths];
    arriving.high = arriving.low + suns * arriving.wavelengths;
    arriving.along_sun = at.sun - double(k);
    arriving.along_altitude = at.altitude - double(i);
    return arriving;
}

double LightGuide::Arriving::operator()(size_t i) const {
    return std::lerp(std::lerp(low[i], low[wavelengths + i], along_sun),
                     std::lerp(high[i], high[wavelengths + i], along_sun), along_altitude);
}

/// `weight` of a direction's z, and its x and y.
template <class F>
LightGuide::Lobe LightGuide::weighted(double h, double mu_sun, const F& weight) const {
    const Place at = place(h, mu_sun);
    const double* const light =
        &light_[(size_t(at.altitude + 0.5) * suns + size_t(at.sun + 0.5)) * zeniths * azimuths];
    Lobe lobe;
    lobe.horizon_mu = optics_.horizon_mu(h);
    for (size_t z = 0; z < zeniths; ++z) {
        const double mu = 0.5 * (edge(lobe.horizon_mu, double(z)) + edge(lobe.horizon_mu, double(z + 1)));
        const double sine = sine_of(mu);
        double* const row = &lobe.by_azimuth[z * azimuths * Lobe::sides];
        for (size_t k = 0; k < azimuths; ++k) {
            const glm::dvec2 level = level_[k];
            row[azimuths + k] = light[z * azimuths + k] * weight(mu, sine * level);
            row[azimuths - 1 - k] =
                light[z * azimuths + k] * weight(mu, sine * glm::dvec2(level.x, -level.y));
        }
        lobe.by_zenith[z] = accumulate(row, azimuths * Lobe::sides);
    }
    accumulate(lobe.by_zenith.data(), zeniths);
    return lobe;
}

LightGuide::Lobe LightGuide::lobe(double h, double mu_sun) const {
    return weighted(h, mu_sun, [](double, glm::dvec2) { return 1.0; });
}

LightGuide::Lobe LightGuide::lobe(double h, double mu_sun, glm::dvec3 along, double by_mie) const {
    const double g = optics_.atmosphere().mie ? optics_.atmosphere().mie->g : 0;
    return weighted(h, mu_sun, [&](double mu, glm::dvec2 level) {
        const double nu = along.z * mu + along.x * level.x + along.y * level.y;
        return by_mie * henyey_greenstein(nu, g) + (1 - by_mie) * rayleigh_phase(nu);
    });
}

glm::dvec3 LightGuide::Lobe::sample(glm::dvec2 u) const {
    size_t zenith = 0, azimuth = 0;
    const double t = draw(by_zenith.data(), zeniths, u.x, zenith);
    const double mu = std::lerp(edge(horizon_mu, double(zenith)), edge(horizon_mu, double(zenith + 1)), t);
    const double part = draw(&by_azimuth[zenith * azimuths * sides], azimuths * sides, u.y, azimuth);
    const double from = azimuth_edge(azimuth), to = azimuth_edge(azimuth + 1);
    const double phi = std::lerp(from, to, part), sine = sine_of(mu);
    return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

double LightGuide::Lobe::density(glm::dvec3 direction) const {
    const double above_horizon = direction.z - horizon_mu;
    const double t = above_horizon < 0 ? below * (1 - std::sqrt(-above_horizon / (horizon_mu + 1)))
                                       : below + above * std::sqrt(above_horizon / (1 - horizon_mu));
    const size_t zenith = std::min(size_t(std::max(t, 0.0)), zeniths - 1);
    const double phi = std::atan2(direction.y, direction.x);
    const size_t steps = std::min(size_t(std::sqrt(std::abs(phi) / pi) * azimuths), azimuths - 1);
    const size_t azimuth = phi < 0 ? azimuths - 1 - steps : azimuths + steps;
    const auto mass = [](const double* sums, size_t i) { return sums[i] - (i > 0 ? sums[i - 1] : 0); };
    return mass(by_zenith.data(), zenith) * mass(&by_azimuth[zenith * azimuths * sides], azimuth) /
           ((edge(horizon_mu, double(zenith + 1)) - edge(horizon_mu, double(zenith))) *
            (azimuth_edge(azimuth + 1) - azimuth_edge(azimuth)));
}

/// From -pi to pi: squares on both sides of 0.
double LightGuide::azimuth_edge(size_t azimuth) {
    const double t = double(azimuth) / azimuths - 1;
    return pi * t * std::abs(t);
}

}  // namespace lumo::reference
