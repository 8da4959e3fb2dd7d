// The sky: transmittance, sun, radiance and irradiance anywhere in and above the air. Include once per program; takes
// bindings atmosphere_binding to atmosphere_binding + 3.
//
// Altitudes and distances in km, 0 and up. mu: cosine between the view and the vertical at the camera; mu_sun: between
// the direction toward the sun and that vertical; nu: between view and sun. Results have a component for each wavelength,
// in W/m²/nm/sr, W/m²/nm, or 1. A camera above the air looks from where its ray enters it. A reflection by the ground
// counts as an order of scattering, and radiance leaves out light that comes straight from the ground.
#include "atmosphere/air.glsl"
#include "atmosphere/columns.glsl"
#include "atmosphere/scattering.glsl"

// Beyond every distance.
const float all_of_ray = 1e30;

// 0 where the ray ends at the ground.
vec4 transmittance_to_space(float altitude, float mu) {
    AirPath path = air_path(RayPoint(altitude, mu));
    if (path.ground) return vec4(0);
    return path.extent > 0.0 ? transmittance_of(columns_along(path).past) : vec4(1);
}

// Over a distance; 0 where the ground lies between.
vec4 transmittance_segment(float altitude, float mu, float distance) {
    AirPath path = air_path(RayPoint(altitude, mu));
    float inside = distance - path.entry;
    if (inside <= 0.0) return vec4(1);
    // The ground itself is still seen: what ends there is known no better than to its last places.
    if (path.ground && inside > path.extent * (1.0 + 1e-5) + 1e-6) return vec4(0);
    if (path.extent <= 0.0) return vec4(1);
    inside = min(inside, path.extent);
    return transmittance_of(columns_to(columns_along(path), ray_after(path.at, inside), inside));
}

// On a plane that faces the sun: that of the point-like sun, faded by how much of the disc is above the horizon.
vec4 sun_irradiance_facing(float altitude, float mu_sun) {
    float visible = sun_visibility(altitude, mu_sun);
    if (visible <= 0.0) return vec4(0);
    vec4 transmittance = altitude > air.height ? vec4(1) : transmittance_of(columns_to_sun(altitude, mu_sun));
    return visible * transmittance * air.sun_irradiance;
}

// On a level plane.
vec4 sun_irradiance(float altitude, float mu_sun) {
    return mu_sun > 0.0 ? mu_sun * sun_irradiance_facing(altitude, mu_sun) : vec4(0);
}

vec4 sky_light(float altitude, float mu, float mu_sun, float nu, float distance, bool again) {
    AirPath path = air_path(RayPoint(altitude, mu));
    float length = min(path.extent, distance - path.entry);
    if (!(length > 0.0)) return vec4(0);
    float mu_sun_there = (radius_at(max(altitude, 0.0)) * mu_sun + nu * path.entry) / radius_at(path.at.altitude);
    return air.sun_irradiance * light_along(path, length, clamp(mu_sun_there, -1.0, 1.0), nu, true,
                                            again ? all_forward : vec3(0), again);
}

// Of all orders, scattered toward the camera within a distance.
vec4 sky_radiance(float altitude, float mu, float mu_sun, float nu, float distance) {
    return sky_light(altitude, mu, mu_sun, nu, distance, air.orders > 1);
}

// Of light that was scattered once.
vec4 sky_radiance_order1(float altitude, float mu, float mu_sun, float nu, float distance) {
    return sky_light(altitude, mu, mu_sun, nu, distance, false);
}

// Of the sky, without the sun, on a level plane that faces up.
vec4 sky_irradiance(float altitude, float mu_sun) {
    if (altitude > air.height) return vec4(0);
    return air.sun_irradiance * sky_irradiance_at(max(altitude, 0.0), mu_sun, all_forward);
}
