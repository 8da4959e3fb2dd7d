// The air before a surface that the camera sees. Include after sky/view.glsl and common/camera.glsl.

struct AirBefore {
    vec4 radiance;       // scattered toward the eye on the way
    vec4 transmittance;
};

// The ground of the planet lies no nearer than a surface that is seen.
AirBefore air_over(vec3 direction, float distance) {
    float mu = clamp(dot(direction, sky.up), -1.0, 1.0);
    float mu_sun = clamp(dot(sky.to_sun, sky.up), -1.0, 1.0);
    float nu = clamp(dot(direction, sky.to_sun), -1.0, 1.0);
    AirPath path = air_path(RayPoint(sky.altitude, mu));
    float end = path.ground ? min(distance, path.entry + path.extent) : distance;
    return AirBefore(sky_radiance(sky.altitude, mu, mu_sun, nu, end), transmittance_segment(sky.altitude, mu, end));
}

// `position` in the world, `at` the pixel's coordinates that show it.
AirBefore air_before_surface(vec3 position, vec2 at) {
    bool perspective = camera.eye.w > 0.0;
    vec3 path = position - (perspective ? camera.eye.xyz : world_from_pixel(at, 0.0));
    float distance = sqrt(dot(path, path));
    return air_over(perspective ? path / max(distance, 1e-12) : -camera.eye.xyz, 0.001 * distance);
}
