// What the sky looks like from one place, in linear Rec. 709. Include after atmosphere/sky.glsl; the includer defines SKY,
// the block's binding. Filled by lumo::sky::Sky.
layout(std140, binding = SKY) uniform Sky {
    vec4 red;     // channels of radiance, W/m²/sr, are products with spectral radiance
    vec4 green;
    vec4 blue;
    vec4 sunlit_red;  // and those of transmittance, which is that of sunlight
    vec4 sunlit_green;
    vec4 sunlit_blue;
    vec4 limb;    // of the sun's disc: exponent of the cosine
    vec3 up;      // away from the planet's centre
    float altitude;  // km
    vec3 to_sun;
    float sun_radius;  // angular
} sky;

vec3 rgb_of(vec4 radiance) {
    return vec3(dot(sky.red, radiance), dot(sky.green, radiance), dot(sky.blue, radiance));
}

vec3 rgb_of_transmittance(vec4 transmittance) {
    return vec3(dot(sky.sunlit_red, transmittance), dot(sky.sunlit_green, transmittance),
                dot(sky.sunlit_blue, transmittance));
}

// Spectral radiance from a direction: the air's, and that of the ground behind it; not the sun's disc.
vec4 radiance_from(vec3 direction) {
    float mu = clamp(dot(direction, sky.up), -1.0, 1.0);
    float mu_sun = clamp(dot(sky.to_sun, sky.up), -1.0, 1.0);
    float nu = clamp(dot(direction, sky.to_sun), -1.0, 1.0);
    vec4 radiance = sky_radiance(sky.altitude, mu, mu_sun, nu, all_of_ray);
    AirPath path = air_path(RayPoint(sky.altitude, mu));
    if (path.ground) {
        float distance = path.entry + path.extent;
        float mu_sun_there =
            clamp((radius_at(sky.altitude) * mu_sun + nu * distance) / air.radius_ground, -1.0, 1.0);
        vec4 irradiance = sun_irradiance(0.0, mu_sun_there) + sky_irradiance(0.0, mu_sun_there);
        radiance += air.ground_albedo / pi * irradiance * transmittance_segment(sky.altitude, mu, distance);
    }
    return radiance;
}

// Spectral radiance of the sun's disc, as a mean over a square of `pixel` radians has it: spread so far that its second
// moment grows by that of the square, and dimmer by as much. Its limb is darker (Hestroffer and Magnan 1998, Wavelength
// dependency of the Solar limb darkening): cosine^limb, over its mean over the disc.
vec4 sun_disc(vec3 direction, float pixel) {
    vec3 aside = direction - sky.to_sun;  // the chord is the arc to 1e-5 where the disc is
    float spread = sky.sun_radius * sky.sun_radius + pixel * pixel / 3.0;
    float cosine_squared = 1.0 - dot(aside, aside) / max(spread, 1e-20);
    vec4 radiance = vec4(0);
    if (cosine_squared > 0.0 && sky.sun_radius > 0.0) {
        radiance = air.sun_irradiance / (pi * spread) * (0.5 * sky.limb + 1.0) * pow(vec4(cosine_squared), 0.5 * sky.limb) *
                   transmittance_to_space(sky.altitude, clamp(dot(direction, sky.up), -1.0, 1.0));
    }
    return radiance;
}
