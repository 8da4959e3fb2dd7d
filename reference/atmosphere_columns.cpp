#include "reference/atmosphere_columns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumo::reference {
namespace {

Densities mixed(const Densities& a, const Densities& b, double t) {
    return {.rayleigh = a.rayleigh + t * (b.rayleigh - a.rayleigh),
            .mie = a.mie + t * (b.mie - a.mie),
            .ozone = a.ozone + t * (b.ozone - a.ozone)};
}

Densities product(const Densities& a, const Densities& b) {
    return {.rayleigh = a.rayleigh * b.rayleigh, .mie = a.mie * b.mie, .ozone = a.ozone * b.ozone};
}

double ratio(double column, double to) { return to > 0 ? column / to : 0; }

}  // namespace

ColumnTable::ColumnTable(const AtmosphereOptics& optics) : optics_(optics), grid_(altitudes * cosines) {
    const Atmosphere& a = optics.atmosphere();
    if (a.rayleigh) rayleigh_scale_ = a.rayleigh->scale_height_km;
    if (a.mie) mie_scale_ = a.mie->scale_height_km;
    for (size_t i = 0; i < altitudes; ++i) {
        const double part = double(i) / (altitudes - 1);
        const double h = a.height_km() * part * part;
        const Densities local = optics.densities(h);
        for (size_t k = 0; k < cosines; ++k) {
            const double mu = std::pow(double(k) / (cosines - 1), 2);
            const auto path = optics.air_path({.h = h, .mu = mu});
            const Densities column = optics.column(path->at, path->length);
            const Densities by = product(slant(h, mu), {local.rayleigh, local.mie, 1});
            grid_[i * cosines + k] = {.rayleigh = ratio(column.rayleigh, by.rayleigh),
                                      .mie = ratio(column.mie, by.mie),
                                      .ozone = column.ozone};
        }
    }
}

Densities ColumnTable::slant(double h, double mu) const {
    const double curved = 8 / (std::numbers::pi * optics_.radius(h));
    const auto of = [&](double scale) { return 2 * scale / (mu + std::sqrt(mu * mu + curved * scale)); };
    return {.rayleigh = of(rayleigh_scale_), .mie = of(mie_scale_), .ozone = 1};
}

Densities ColumnTable::rising(RayPoint from, const Densities& densities) const {
    const double mu = std::clamp(from.mu, 0.0, 1.0);
    const double y =
        std::sqrt(std::clamp(from.h / optics_.atmosphere().height_km(), 0.0, 1.0)) * (altitudes - 1);
    const double x = std::sqrt(mu) * (cosines - 1);
    const size_t i = std::min(size_t(y), altitudes - 2), k = std::min(size_t(x), cosines - 2);
    const Densities* low = &grid_[i * cosines + k];
    const Densities* high = low + cosines;
    const double t = x - double(k);
    const Densities relative = mixed(mixed(low[0], low[1], t), mixed(high[0], high[1], t), y - double(i));
    return product(relative, product(slant(from.h, mu), {densities.rayleigh, densities.mie, 1}));
}

Densities ColumnTable::level(double h) const { return rising({.h = h, .mu = 0}, optics_.densities(h)); }

Densities ColumnTable::to_sun(double h, double mu_sun, const Densities& densities) const {
    if (mu_sun >= 0) return rising({.h = h, .mu = mu_sun}, densities);
    const double mu = std::max(mu_sun, optics_.horizon_mu(h));
    const double perigee = h - optics_.radius(h) * mu * mu / (1 + std::sqrt((1 - mu) * (1 + mu)));
    const Densities half = level(std::max(perigee, 0.0));
    const Densities behind = rising({.h = h, .mu = -mu}, densities);
    return {.rayleigh = 2 * half.rayleigh - behind.rayleigh,
            .mie = 2 * half.mie - behind.mie,
            .ozone = 2 * half.ozone - behind.ozone};
}

}  // namespace lumo::reference
