// One layer of a frame as linear float, from whichever target holds it.
#define CAMERA 2
#include "common/camera.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool distance_layer = false;  // the source is depth: write the distance

layout(push_constant) uniform Push {
    vec4 axis_plane;  // dot with (world, 1) is the distance along the optical axis, metres
} push;

layout(binding = 0) uniform sampler2D source;
layout(binding = 1, rgba32f) writeonly uniform image2D layer;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(layer)))) return;

    vec4 value = texelFetch(source, pixel, 0);
    if (distance_layer) {
        vec3 world = world_from_pixel(vec2(pixel) + 0.5, value.r);
        value = value.r < 1.0 ? vec4(dot(push.axis_plane, vec4(world, 1))) : vec4(0);
    }
    imageStore(layer, pixel, vec4(value.rgb, 1));
}
