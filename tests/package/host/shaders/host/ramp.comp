#include "common/color.glsl"  // lumo's

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) writeonly uniform image2D radiance;

layout(push_constant) uniform Push { float step; } push;

// White of the luminance x * step.
void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(radiance)))) return;
    float value = float(pixel.x) * push.step / luminance(vec3(1));
    imageStore(radiance, pixel, vec4(value, value, value, 1));
}
