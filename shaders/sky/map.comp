// Level 0 of the sky's map (sky/map.glsl): radiance by direction.
const int atmosphere_binding = 0;
#include "atmosphere/sky.glsl"
#define SKY 4
#include "sky/octahedron.glsl"
#include "sky/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    int add;  // 1: to what other wavelengths gave
} push;

layout(binding = 5, rgba32f) LUMO_READ_WRITE uniform image3D map;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(map).xy;
    if (any(greaterThanEqual(texel, size))) return;
    vec2 place = 2.0 * vec2(texel) / vec2(size - 1) - 1.0;
    vec3 radiance = rgb_of(radiance_from(direction_at(place)));
    if (push.add != 0) radiance += imageLoad(map, ivec3(texel, 0)).rgb;
    imageStore(map, ivec3(texel, 0), vec4(radiance, 1));
}
