// The sky behind every pixel and the air before it: the radiance that is added to what a surface sends, and the part of
// that which gets through; where nothing was drawn, the sky with the sun's disc.
const int atmosphere_binding = 0;
#include "atmosphere/sky.glsl"
#define CAMERA 4
#define SKY 5
#include "common/camera.glsl"
#include "sky/view.glsl"
#include "sky/before.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    int add;     // 1: to what other wavelengths gave
    int behind;  // 1: pixels where nothing was drawn; 0: the others
} push;

layout(binding = 6) uniform sampler2D depth;
layout(binding = 7, rgba32f) LUMO_READ_WRITE uniform image2D radiance;
layout(binding = 8, rgba32f) LUMO_READ_WRITE uniform image2D transmittance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(radiance)))) return;

    float pixel_depth = texelFetch(depth, pixel, 0).r;
    if ((pixel_depth == 1.0) != (push.behind == 1)) return;
    vec2 at = vec2(pixel) + 0.5;
    AirBefore seen;
    if (pixel_depth < 1.0) {
        seen = air_before_surface(world_from_pixel(at, pixel_depth), at);
    } else {
        bool perspective = camera.eye.w > 0.0;
        vec3 direction = perspective ? unit(camera.corner + camera.across * at.x + camera.along * at.y) : -camera.eye.xyz;
        float pixel_angle = perspective ? sqrt(dot(camera.along, camera.along)) : 0.0;
        seen = AirBefore(radiance_from(direction) + sun_disc(direction, pixel_angle), vec4(1));
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
