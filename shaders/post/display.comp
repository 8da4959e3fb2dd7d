// From radiance to what a display shows: exposure, tone curve, sRGB.
#include "post/tone_curves.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int tonemap = 0;  // lumo::post::Tonemap

layout(push_constant) uniform Push {
    float exposure;  // a factor
} push;

layout(binding = 0) uniform sampler2D radiance;
layout(binding = 1, rgba8) writeonly uniform image2D display;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(display)))) return;
    // Far above white every curve has ended; the bound keeps their terms finite.
    vec3 color = clamp(push.exposure * texelFetch(radiance, pixel, 0).rgb, 0, 65536);
    switch (tonemap) {
        case 1: color = tonemap_reinhard(color); break;
        case 2: color = tonemap_hable(color); break;
        case 3: color = tonemap_aces(color); break;
        case 4: color = tonemap_agx(color); break;
        default: color = min(color, 1);
    }
    imageStore(display, pixel, vec4(srgb_encode(color), 1));
}
