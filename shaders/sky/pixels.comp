// The sky behind every pixel and the air before it: the radiance that is added to what a surface sends, and the part of
// that which gets through; where nothing was drawn, the sky with the sun's disc.
const int atmosphere_binding = 0;
#include "atmosphere/sky.glsl"
#define CAMERA 4
#define SKY 5
#include "common/camera.glsl"
#include "sky/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    int add;     // 1: to what other wavelengths gave
    int behind;  // 1: pixels where nothing was drawn; 0: the others
} push;

layout(binding = 6) uniform sampler2D depth;
layout(binding = 7, rgba32f) LUMO_READ_WRITE uniform image2D radiance;
layout(binding = 8, rgba32f) LUMO_READ_WRITE uniform image2D transmittance;

struct Seen {
    vec4 radiance;
    vec4 transmittance;
};

// The ground of the planet lies no nearer than a surface that is seen.
Seen seen_before(vec3 direction, float distance) {
    float mu = clamp(dot(direction, sky.up), -1.0, 1.0);
    float mu_sun = clamp(dot(sky.to_sun, sky.up), -1.0, 1.0);
    float nu = clamp(dot(direction, sky.to_sun), -1.0, 1.0);
    AirPath path = air_path(RayPoint(sky.altitude, mu));
    float end = path.ground ? min(distance, path.entry + path.extent) : distance;
    return Seen(sky_radiance(sky.altitude, mu, mu_sun, nu, end), transmittance_segment(sky.altitude, mu, end));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(radiance)))) return;

    float pixel_depth = texelFetch(depth, pixel, 0).r;
    if ((pixel_depth == 1.0) != (push.behind == 1)) return;
    vec2 at = vec2(pixel) + 0.5;
    bool perspective = camera.eye.w > 0.0;
    Seen seen;
    if (pixel_depth < 1.0) {
        vec3 path = world_from_pixel(at, pixel_depth) - (perspective ? camera.eye.xyz : world_from_pixel(at, 0.0));
        float distance = sqrt(dot(path, path));
        seen = seen_before(perspective ? path / max(distance, 1e-12) : -camera.eye.xyz, 0.001 * distance);
    } else {
        vec3 direction = perspective ? unit(camera.corner + camera.across * at.x + camera.along * at.y) : -camera.eye.xyz;
        float pixel_angle = perspective ? sqrt(dot(camera.along, camera.along)) : 0.0;
        seen = Seen(radiance_from(direction) + sun_disc(direction, pixel_angle), vec4(1));
    }
    vec3 added = rgb_of(seen.radiance);
    vec3 through = rgb_of_transmittance(seen.transmittance);
    if (push.add != 0) {
        added += imageLoad(radiance, pixel).rgb;
        through += imageLoad(transmittance, pixel).rgb;
    }
    imageStore(radiance, pixel, vec4(added, 1));
    imageStore(transmittance, pixel, vec4(through, 1));
}
