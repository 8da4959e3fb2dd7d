#include "reference/atmosphere_optics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

double smoothstep(double from, double to, double x) {
    if (x <= from) return 0;
    if (x >= to) return 1;
    const double t = (x - from) / (to - from);
    return t * t * (3 - 2 * t);
}

}  // namespace

Densities& Densities::operator+=(const Densities& other) {
    rayleigh += other.rayleigh;
    mie += other.mie;
    ozone += other.ozone;
    return *this;
}

double rayleigh_phase(double nu) { return 3 / (16 * pi) * (1 + nu * nu); }

double cornette_shanks_phase(double nu, double g) {
    const double base = 1 + g * g - 2 * g * nu;
    return 3 / (8 * pi) * (1 - g * g) / (2 + g * g) * (1 + nu * nu) / (base * std::sqrt(base));
}

double cos_degrees(double degrees) { return std::sin((90 - std::abs(degrees)) * (pi / 180)); }

AtmosphereOptics::AtmosphereOptics(Atmosphere atmosphere) : a_(std::move(atmosphere)) {
    const auto add_scale = [&](double scale_height) {
        for (double h = scale_height; h < std::min(a_.height_km(), 64 * scale_height); h *= 2)
            borders_.push_back(h);
    };
    if (a_.rayleigh) add_scale(a_.rayleigh->scale_height_km);
    if (a_.mie) add_scale(a_.mie->scale_height_km);
    if (a_.ozone) {
        for (const double h : {a_.ozone->bottom_km, a_.ozone->peak_km, a_.ozone->top_km})
            if (h > 0 && h < a_.height_km()) borders_.push_back(h);
    }
    std::ranges::sort(borders_);
}

RayPoint AtmosphereOptics::along(RayPoint from, double distance) const {
    const double r = radius(from.h);
    const double change = distance * (distance + 2 * r * from.mu);
    const double r_there = std::sqrt(std::max(r * r + change, 0.0));
    return {.h = std::max(from.h + change / (r + r_there), 0.0),
            .mu = std::clamp((r * from.mu + distance) / r_there, -1.0, 1.0)};
}

std::optional<AirPath> AtmosphereOptics::air_path(RayPoint from) const {
    const double top = a_.height_km();
    AirPath path{.at = from};
    if (from.h > top) {
        const double b = radius(from.h) * from.mu;
        const double outside = (from.h - top) * (radius(from.h) + a_.radius_top_km);
        const double discriminant = b * b - outside;
        if (b >= 0 || discriminant <= 0) return std::nullopt;
        path.entry = outside / (-b + std::sqrt(discriminant));
        path.at = {.h = top, .mu = -std::sqrt(discriminant) / a_.radius_top_km};
    }
    const double b = radius(path.at.h) * path.at.mu;
    const double above = path.at.h * (2 * a_.radius_ground_km + path.at.h);
    if (b < 0 && b * b > above) {
        path.length = above / (-b + std::sqrt(b * b - above));
        path.ground = true;
    } else {
        const double below = (top - path.at.h) * (radius(path.at.h) + a_.radius_top_km);
        const double root = std::sqrt(b * b + below);
        path.length = b >= 0 ? (below > 0 ? below / (b + root) : 0) : root - b;
    }
    return path;
}

double AtmosphereOptics::horizon_mu(double h) const {
    return -std::sqrt(h * (2 * a_.radius_ground_km + h)) / radius(h);
}

Densities AtmosphereOptics::densities(double h) const {
    Densities d;
    if (h > a_.height_km() * (1 + 1e-12)) return d;
    if (a_.rayleigh) d.rayleigh = std::exp(-h / a_.rayleigh->scale_height_km);
    if (a_.mie) d.mie = std::exp(-h / a_.mie->scale_height_km);
    if (a_.ozone) {
        const scene::OzoneSpecies& o = *a_.ozone;
        d.ozone = std::max(0.0, std::min((h - o.bottom_km) / (o.peak_km - o.bottom_km),
                                         (o.top_km - h) / (o.top_km - o.peak_km)));
    }
    return d;
}

/// The distance at which a ray that rises from a point reaches an altitude that is not lower.
double AtmosphereOptics::to_altitude(RayPoint from, double h) const {
    const double b = radius(from.h) * from.mu;
    const double change = (h - from.h) * (2 * a_.radius_ground_km + from.h + h);
    return change > 0 ? change / (b + std::sqrt(b * b + change)) : 0;
}

/// In pieces of 2, 4, 8 and 16 scale heights of altitude, each by 8 nodes: where the ray is steep the integrand is
/// exp(-x), where it is level exp(-x²), over a range for which the rule's error is below 1e-9 of the whole. Beyond 30
/// scale heights the rest is below 1e-13 of it.
double AtmosphereOptics::exponential(RayPoint low, double length, double scale_height) const {
    const double b = 2 * radius(low.h) * low.mu;
    const double r = radius(low.h);
    double sum = 0, begin = 0;
    for (const double scales : {2.0, 6.0, 14.0, 30.0}) {
        const double end = std::min(length, to_altitude(low, low.h + scales * scale_height));
        gauss(begin, end, [&](double d, double weight) {
            const double change = d * (d + b);
            sum += weight * std::exp(-change / (r + std::sqrt(r * r + change)) / scale_height);
        });
        if (end >= length) break;
        begin = end;
    }
    return sum * std::exp(-low.h / scale_height);
}

/// With s the distance from the perigee at radius p, the radius is sqrt(s² + p²), whose integral is
/// (s r + p² ln(s + r)) / 2: the density, linear in the radius, has a closed form on each side of the peak.
double AtmosphereOptics::ozone(RayPoint low, double length) const {
    const scene::OzoneSpecies& o = *a_.ozone;
    const double r0 = radius(low.h), s0 = r0 * low.mu;
    const double p2 = r0 * r0 * (1 - low.mu) * (1 + low.mu);
    const auto part = [&](double h_begin, double h_end, double h_zero, double slope) {
        const double begin = std::min(length, to_altitude(low, h_begin));
        const double end = std::min(length, to_altitude(low, h_end));
        if (end <= begin) return 0.0;
        const double s1 = s0 + begin, s2 = s0 + end;
        const double r1 = std::sqrt(s1 * s1 + p2), r2 = std::sqrt(s2 * s2 + p2);
        const double radii = 0.5 * (s2 * r2 - s1 * r1 + p2 * std::log((s2 + r2) / (s1 + r1)));
        return slope * (radii - radius(h_zero) * (end - begin));
    };
    return part(o.bottom_km, o.peak_km, o.bottom_km, 1 / (o.peak_km - o.bottom_km)) +
           part(o.peak_km, o.top_km, o.top_km, -1 / (o.top_km - o.peak_km));
}

Densities AtmosphereOptics::upward(RayPoint low, double length) const {
    Densities sum;
    if (a_.rayleigh) sum.rayleigh = exponential(low, length, a_.rayleigh->scale_height_km);
    if (a_.mie) sum.mie = exponential(low, length, a_.mie->scale_height_km);
    if (a_.ozone) sum.ozone = ozone(low, length);
    return sum;
}

Densities AtmosphereOptics::column(RayPoint from, double length) const {
    if (from.mu >= 0) return upward(from, length);
    const double r = radius(from.h), perigee = -r * from.mu;
    if (length <= perigee) {
        const RayPoint end = along(from, length);
        return upward({.h = end.h, .mu = std::max(-end.mu, 0.0)}, length);
    }
    const double lowest = from.h - r * from.mu * from.mu / (1 + std::sqrt((1 - from.mu) * (1 + from.mu)));
    const RayPoint low{.h = std::max(lowest, 0.0), .mu = 0};
    Densities sum = upward(low, perigee);
    return sum += upward(low, length - perigee);
}

double AtmosphereOptics::extinction(const Densities& d, size_t i) const {
    return (a_.rayleigh ? a_.rayleigh->scattering_per_km[i] * d.rayleigh : 0) +
           (a_.mie ? a_.mie->extinction_per_km[i] * d.mie : 0) +
           (a_.ozone ? a_.ozone->extinction_per_km[i] * d.ozone : 0);
}

double AtmosphereOptics::scattering(const Densities& d, size_t i) const {
    return (a_.rayleigh ? a_.rayleigh->scattering_per_km[i] * d.rayleigh : 0) +
           (a_.mie ? a_.mie->scattering_per_km[i] * d.mie : 0);
}

Spectrum AtmosphereOptics::transmittance(const Densities& column) const {
    Spectrum t(wavelengths());
    for (size_t i = 0; i < t.size(); ++i) t[i] = std::exp(-extinction(column, i));
    return t;
}

Spectrum AtmosphereOptics::transmittance_to_space(RayPoint from) const {
    const auto path = air_path(from);
    if (!path) return Spectrum(wavelengths(), 1);
    return path->ground ? Spectrum(wavelengths(), 0) : transmittance(column(path->at, path->length));
}

Spectrum AtmosphereOptics::transmittance_segment(RayPoint from, double distance) const {
    const auto path = air_path(from);
    if (!path || distance <= path->entry) return Spectrum(wavelengths(), 1);
    const double inside = distance - path->entry;
    // The ground itself is still seen: a distance that ends there is known no better than to its last places.
    if (path->ground && inside > path->length + 1e-12 * a_.radius_ground_km)
        return Spectrum(wavelengths(), 0);
    return transmittance(column(path->at, std::min(inside, path->length)));
}

double AtmosphereOptics::sun_visibility(double h, double mu_sun) const {
    const double half = a_.sun_angular_radius_deg * (pi / 180) * a_.radius_ground_km / radius(h);
    return smoothstep(-half, half, mu_sun - horizon_mu(h));
}

Densities AtmosphereOptics::sun_column(double h, double mu_sun) const {
    const double horizon = horizon_mu(h);
    if (mu_sun > horizon) {
        const auto path = air_path({.h = h, .mu = mu_sun});
        if (!path) return {};
        if (!path->ground) return column(path->at, path->length);
    }
    const double to_perigee = -radius(h) * horizon;
    const double from_perigee = std::sqrt(a_.height_km() * (a_.radius_top_km + a_.radius_ground_km));
    Densities sum = upward({.h = 0, .mu = 0}, to_perigee);
    return sum += upward({.h = 0, .mu = 0}, from_perigee);
}

Spectrum AtmosphereOptics::sun_irradiance(double h, double mu_sun) const {
    const double part = sun_visibility(h, mu_sun) * std::max(mu_sun, 0.0);
    Spectrum e(wavelengths(), 0);
    if (part <= 0) return e;
    e = h > a_.height_km() ? Spectrum(wavelengths(), 1) : transmittance(sun_column(h, mu_sun));
    for (size_t i = 0; i < e.size(); ++i) e[i] *= part * a_.sun_irradiance[i];
    return e;
}

}  // namespace lumo::reference
