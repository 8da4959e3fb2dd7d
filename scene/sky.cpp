#include "scene/sky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace lumo::scene {
namespace {

/// The CIE 1931 2° observer, in XYZ.
glm::dvec3 observer(double wavelength_nm) {
    const auto lobe = [&](double scale, double peak, double below, double above) {
        const double t = (wavelength_nm - peak) * (wavelength_nm < peak ? below : above);
        return scale * std::exp(-0.5 * t * t);
    };
    return {lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) +
                lobe(-0.065, 501.1, 0.0490, 0.0382),
            lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
            lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)};
}

/// IEC 61966-2-1.
glm::dvec3 rec709(glm::dvec3 xyz) {
    return {3.2406255 * xyz.x - 1.5372080 * xyz.y - 0.4986286 * xyz.z,
            -0.9689307 * xyz.x + 1.8757561 * xyz.y + 0.0415175 * xyz.z,
            0.0557101 * xyz.x - 0.2040211 * xyz.y + 1.0569959 * xyz.z};
}

/// Planck's law to a factor.
double black_body(double wavelength_nm) {
    constexpr double second_radiation = 14387768.775;  // nm K
    constexpr double temperature = 5772;
    return std::pow(wavelength_nm / 1000, -5) / std::expm1(second_radiation / (wavelength_nm * temperature));
}

double smoothstep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// Densities along a path, integrated over it; km.
struct Columns {
    double rayleigh = 0, mie = 0, ozone = 0;
};

void add_densities(Columns& sum, const Atmosphere& a, double h, double length) {
    if (a.rayleigh) sum.rayleigh += length * std::exp(-h / a.rayleigh->scale_height_km);
    if (a.mie) sum.mie += length * std::exp(-h / a.mie->scale_height_km);
    if (a.ozone) {
        const OzoneSpecies& o = *a.ozone;
        const double rising = (h - o.bottom_km) / (o.peak_km - o.bottom_km);
        const double falling = (o.top_km - h) / (o.top_km - o.peak_km);
        sum.ozone += length * std::clamp(std::min(rising, falling), 0.0, 1.0);
    }
}

/// Along the whole of a ray that meets no ground.
Columns columns_to_space(const Atmosphere& a, double altitude, double mu) {
    // Distances from the point of the ray that is nearest to the centre, at which the altitude is `lowest`.
    const double r = a.radius_ground_km + altitude, start = r * mu;
    const double sine_squared = std::max(1 - mu * mu, 0.0);
    const double nearest = r * std::sqrt(sine_squared);
    const double lowest = altitude - start * start / (r + nearest);
    if (nearest >= a.radius_top_km) return {};
    const double end = std::sqrt((a.radius_top_km - nearest) * (a.radius_top_km + nearest));
    Columns sum;
    // By Gauss' rule on panels that shrink toward the low end, where the air is dense.
    const auto add = [&](double from, double to) {
        constexpr std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                              0.9602898564975363};
        constexpr std::array<double, 4> weights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                0.1012285362903763};
        constexpr int panels = 32;
        for (int panel = 0; panel < panels; ++panel) {
            for (size_t i = 0; i < 2 * nodes.size(); ++i) {
                const double node = i % 2 ? nodes[i / 2] : -nodes[i / 2];
                const double u = (panel + 0.5 + 0.5 * node) / panels;
                const double x = from + (to - from) * u * u;
                const double h = lowest + x * x / (nearest + std::hypot(nearest, x));
                add_densities(sum, a, h, (to - from) * u * weights[i / 2] / panels);
            }
        }
    };
    if (start >= end) return {};
    if (start < 0) add(0, std::min(-start, end));
    add(std::max(start, 0.0), end);
    return sum;
}

}  // namespace

std::vector<glm::dvec3> rgb_weights(const Spectrum& wavelengths_nm) {
    std::vector<size_t> order(wavelengths_nm.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::ranges::sort(order, {}, [&](size_t i) { return wavelengths_nm[i]; });

    constexpr double first = 360, last = 830, step = 1;
    std::vector<glm::dvec3> weights(wavelengths_nm.size(), glm::dvec3(0));
    for (double at = first; at <= last; at += step) {
        const auto above =
            std::ranges::upper_bound(order, at, {}, [&](size_t i) { return wavelengths_nm[i]; });
        const size_t high = above == order.end() ? order.back() : *above;
        const size_t low = above == order.begin() ? order.front() : *(above - 1);
        const double span = wavelengths_nm[high] - wavelengths_nm[low];
        const double part = span > 0 ? (at - wavelengths_nm[low]) / span : 0;
        const glm::dvec3 color = step * black_body(at) * rec709(observer(at));
        weights[low] += (1 - part) * color;
        weights[high] += part * color;
    }
    for (size_t i = 0; i < weights.size(); ++i) weights[i] /= black_body(wavelengths_nm[i]);
    return weights;
}

glm::dvec3 to_rgb(const std::vector<glm::dvec3>& weights, const Spectrum& spectrum) {
    glm::dvec3 sum(0);
    for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * spectrum[i];
    return glm::max(sum, 0.0);
}

Spectrum sun_transmittance(const Atmosphere& a, double altitude_km, double mu) {
    const double to_ground = a.radius_ground_km / (a.radius_ground_km + altitude_km);
    const double horizon = -std::sqrt((1 - to_ground) * (1 + to_ground));
    const double angular_radius = glm::radians(a.sun_angular_radius_deg) * to_ground;
    const double visible = smoothstep(-angular_radius, angular_radius, mu - horizon);
    Spectrum through(a.wavelengths_nm.size(), visible);
    if (visible == 0) return through;
    // Below the horizon, the air that the visible part of the disc shines through.
    const Columns columns = columns_to_space(a, altitude_km, std::max(mu, horizon));
    for (size_t i = 0; i < through.size(); ++i) {
        double depth = 0;
        if (a.rayleigh) depth += a.rayleigh->scattering_per_km[i] * columns.rayleigh;
        if (a.mie) depth += a.mie->extinction_per_km[i] * columns.mie;
        if (a.ozone) depth += a.ozone->extinction_per_km[i] * columns.ozone;
        through[i] *= std::exp(-depth);
    }
    return through;
}

Light sun_light(const Sky& sky) {
    Spectrum irradiance = sun_transmittance(sky.atmosphere, sky.altitude_km, double(sky.direction_to_sun.y));
    for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] *= sky.atmosphere.sun_irradiance[i];
    return {.name = "sun",
            .intensity = glm::vec3(to_rgb(rgb_weights(sky.atmosphere.wavelengths_nm), irradiance)),
            .direction = -sky.direction_to_sun};
}

Daylight daylight(const Sky& sky) {
    const Atmosphere& a = sky.atmosphere;
    const glm::dvec3 to_sun(sky.direction_to_sun);
    const std::vector<glm::dvec3> weights = rgb_weights(a.wavelengths_nm);
    const double r = a.radius_ground_km + sky.altitude_km;
    const double g = a.mie ? a.mie->g : 0;
    constexpr double pi = 3.14159265358979;
    constexpr int zeniths = 4, azimuths = 4, steps = 24;

    glm::dvec3 irradiance(0);
    for (int direction = 0; direction < (sky.altitude_km < a.height_km() ? zeniths * azimuths : 0);
         ++direction) {
        // As much irradiance of a constant sky from each; the half away from the sun's plane is as the other.
        const double cosine = std::sqrt((direction / azimuths + 0.5) / zeniths);
        const double sine = std::sqrt(1 - cosine * cosine);
        const double azimuth = pi * (direction % azimuths + 0.5) / azimuths + std::atan2(to_sun.z, to_sun.x);
        const glm::dvec3 way(sine * std::cos(azimuth), cosine, sine * std::sin(azimuth));
        const double nu = glm::dot(way, to_sun);
        const double rayleigh_phase = 3 / (16 * pi) * (1 + nu * nu);
        const double mie_phase = 3 / (8 * pi) * (1 - g * g) * (1 + nu * nu) /
                                 ((2 + g * g) * std::pow(1 + g * g - 2 * g * nu, 1.5));
        const double end =
            -r * cosine + std::sqrt((a.radius_top_km - r * sine) * (a.radius_top_km + r * sine));
        Columns before;
        Spectrum radiance(weights.size(), 0.0);
        for (int i = 0; i < steps; ++i) {
            const double from = end * (i * i) / (steps * steps),
                         to = end * ((i + 1) * (i + 1)) / (steps * steps);
            const glm::dvec3 at = glm::dvec3(0, r, 0) + 0.5 * (from + to) * way;
            const double altitude = glm::length(at) - a.radius_ground_km;
            Columns step;
            add_densities(step, a, altitude, to - from);
            const Spectrum sunlight = sun_transmittance(a, altitude, glm::dot(at, to_sun) / glm::length(at));
            for (size_t w = 0; w < radiance.size(); ++w) {
                double depth = 0, scattered = 0;
                if (a.rayleigh) {
                    depth += a.rayleigh->scattering_per_km[w] * (before.rayleigh + 0.5 * step.rayleigh);
                    scattered += a.rayleigh->scattering_per_km[w] * step.rayleigh * rayleigh_phase;
                }
                if (a.mie) {
                    depth += a.mie->extinction_per_km[w] * (before.mie + 0.5 * step.mie);
                    scattered += a.mie->scattering_per_km[w] * step.mie * mie_phase;
                }
                if (a.ozone) depth += a.ozone->extinction_per_km[w] * (before.ozone + 0.5 * step.ozone);
                radiance[w] += a.sun_irradiance[w] * sunlight[w] * scattered * std::exp(-depth);
            }
            before.rayleigh += step.rayleigh;
            before.mie += step.mie;
            before.ozone += step.ozone;
        }
        irradiance += pi / (zeniths * azimuths) * to_rgb(weights, radiance);
    }
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    return {.sun = glm::dot(glm::dvec3(sun_light(sky).intensity), luminance),
            .sky = glm::dot(irradiance, luminance)};
}

void set_sky(Scene& scene, Sky sky) {
    std::erase_if(scene.lights, [](const Light& light) { return light.kind == LightKind::directional; });
    scene.lights.insert(scene.lights.begin(), sun_light(sky));
    scene.environment_radiance = glm::vec3(0);
    scene.sky = std::move(sky);
}

}  // namespace lumo::scene
