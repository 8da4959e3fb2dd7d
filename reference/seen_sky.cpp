#include "reference/seen_sky.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/sky.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = glm::pi<double>();
constexpr double quadrature_tolerance = 1e-4;

double degrees_between(glm::dvec3 a, glm::dvec3 b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

}  // namespace

SeenSky::SeenSky(const scene::Sky& sky, glm::dvec3 eye)
    : sky_(&sky), optics_(sky.atmosphere), weights_(scene::rgb_weights(sky.atmosphere.wavelengths_nm)) {
    for (size_t i = 0; i < weights_.size(); ++i) sunlight_ += weights_[i] * sky.atmosphere.sun_irradiance[i];
    const glm::dvec3 place =
        eye / 1000.0 + glm::dvec3(0, sky.atmosphere.radius_ground_km + sky.altitude_km, 0);
    const double radius = glm::length(place);
    if (radius > 0) up_ = place / radius;
    altitude_km_ = std::max(radius - sky.atmosphere.radius_ground_km, 0.0);
}

SkyView SeenSky::view_of(glm::dvec3 direction) const {
    const glm::dvec3 to_sun = glm::normalize(glm::dvec3(sky_->direction_to_sun));
    // The azimuth, in a plane of which only the turn from one direction to the other counts.
    const glm::dvec3 across = glm::cross(up_, to_sun);
    const double azimuth =
        std::atan2(glm::dot(direction, across), glm::dot(direction, glm::cross(across, up_)));
    return {.altitude_km = altitude_km_,
            .view_zenith_deg = degrees_between(direction, up_),
            .sun_zenith_deg = degrees_between(to_sun, up_),
            .azimuth_deg = glm::degrees(azimuth)};
}

RayPoint SeenSky::start_of(glm::dvec3 direction) const {
    return {.h = altitude_km_, .mu = std::clamp(glm::dot(direction, up_), -1.0, 1.0)};
}

Spectrum SeenSky::scattered(const SkyView& view, const SeenSkyPaths& paths) const {
    Spectrum sum = radiance_order1(optics_, view, quadrature_tolerance);
    const Estimate again =
        radiance(optics_, view,
                 {.first_order = 2, .last_order = all_orders, .samples = paths.count, .seed = paths.seed});
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += again.mean[i];
    return sum;
}

AirBefore SeenSky::over(glm::dvec3 direction, double metres, const SeenSkyPaths& paths) const {
    SkyView view = view_of(direction);
    const RayPoint from = start_of(direction);
    const auto path = optics_.air_path(from);
    view.distance_km = metres / 1000;
    if (path && path->ground) view.distance_km = std::min(view.distance_km, path->entry + path->length);
    Spectrum sunlight = optics_.transmittance_segment(from, view.distance_km);
    for (size_t i = 0; i < sunlight.size(); ++i) sunlight[i] *= sky_->atmosphere.sun_irradiance[i];
    AirBefore air{.radiance = scene::to_rgb(weights_, scattered(view, paths))};
    for (int c = 0; c < 3; ++c)
        if (sunlight_[c] > 0) air.transmittance[c] = scene::to_rgb(weights_, sunlight)[c] / sunlight_[c];
    return air;
}

glm::dvec3 SeenSky::beyond(glm::dvec3 direction, const SeenSkyPaths& paths) const {
    const SkyView view = view_of(direction);
    Spectrum sum = scattered(view, paths);
    const RayPoint from = start_of(direction);
    const auto path = optics_.air_path(from);
    if (path && path->ground) {
        const double distance = path->entry + path->length;
        const glm::dvec3 end = optics_.radius(altitude_km_) * up_ + distance * direction;
        const double sun_zenith = degrees_between(glm::dvec3(sky_->direction_to_sun), end);
        Spectrum irradiance = optics_.sun_irradiance(0, cos_degrees(sun_zenith));
        const Estimate of_sky = sky_irradiance(
            optics_, {.sun_zenith_deg = sun_zenith},
            {.first_order = 1, .last_order = all_orders, .samples = paths.count, .seed = paths.seed});
        // Rounding must not put the ground before its own surface.
        const Spectrum through = optics_.transmittance_segment(from, distance * (1 - 1e-9));
        for (size_t i = 0; i < sum.size(); ++i)
            sum[i] += sky_->atmosphere.ground_albedo[i] / pi * (irradiance[i] + of_sky.mean[i]) * through[i];
    }
    return scene::to_rgb(weights_, sum);
}

double SeenSky::to_sun_disc(glm::dvec3 direction) const {
    return glm::radians(degrees_between(direction, glm::dvec3(sky_->direction_to_sun)) -
                        sky_->atmosphere.sun_angular_radius_deg);
}

glm::dvec3 SeenSky::disc(glm::dvec3 direction) const {
    const scene::Atmosphere& a = sky_->atmosphere;
    const double radius = glm::radians(a.sun_angular_radius_deg);
    const double distance = radius + to_sun_disc(direction);
    if (!(distance < radius)) return glm::dvec3(0);
    Spectrum value = optics_.transmittance_to_space(start_of(direction));
    const double cosine = std::sqrt((1 - distance / radius) * (1 + distance / radius));
    for (size_t i = 0; i < value.size(); ++i) {
        const double exponent = std::clamp(-0.023 + 292 / a.wavelengths_nm[i], 0.1, 1.0);
        value[i] *=
            a.sun_irradiance[i] / (pi * radius * radius) * (0.5 * exponent + 1) * std::pow(cosine, exponent);
    }
    return scene::to_rgb(weights_, value);
}

}  // namespace lumo::reference
