// World positions of a G-buffer's pixels, as passes find them.
#define CAMERA 1
#include "common/camera.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 2, rgba32f) writeonly uniform image2D positions;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(positions)))) return;
    float d = texelFetch(depth, pixel, 0).x;
    vec3 position = world_from_pixel(vec2(pixel) + 0.5, d);
    imageStore(positions, pixel, vec4(position, d < 1 ? 1 : 0));
}
