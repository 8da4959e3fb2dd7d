// What 4 x 4 pixels with cones of their own have gathered, each for a part of the hemisphere: at every pixel the mean over
// the pattern, of the pixels that lie in its surface.
#define CAMERA 4
#include "common/camera.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    float reach;  // metres: what lies as far before or behind the surface's plane counts nothing
} push;

layout(binding = 0) uniform sampler2D gathered;
layout(binding = 1) uniform sampler2D depth;
layout(binding = 2) uniform sampler2D normal_roughness;
layout(binding = 3) uniform sampler2D geometric_normal_occlusion;
layout(binding = 5, rgba32f) writeonly uniform image2D smoothed;

const int side = 4;  // of the pattern
const int tile = 8 + side;
// Surfaces whose normals are as far apart have no more in common.
const float least_cosine = 0.7;

shared vec4 values[tile * tile];     // a: 1 where something was drawn
shared vec4 positions[tile * tile];  // world
shared vec4 normals[tile * tile];    // shading normal

void main() {
    ivec2 size = imageSize(smoothed);
    ivec2 corner = ivec2(gl_WorkGroupID.xy) * 8 - side / 2;
    for (int i = int(gl_LocalInvocationIndex); i < tile * tile; i += 64) {
        ivec2 pixel = corner + ivec2(i % tile, i / tile);
        bool drawn = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, size));
        ivec2 inside = clamp(pixel, ivec2(0), size - 1);
        float pixel_depth = texelFetch(depth, inside, 0).r;
        vec4 normal = texelFetch(normal_roughness, inside, 0);
        drawn = drawn && pixel_depth < 1.0 && normal.xyz != vec3(0);
        values[i] = vec4(texelFetch(gathered, inside, 0).rgb, drawn ? 1.0 : 0.0);
        positions[i] = vec4(world_from_pixel(vec2(inside) + 0.5, pixel_depth), 0);
        normals[i] = drawn ? vec4(unit(normal.xyz), 0) : vec4(0);
    }
    barrier();

    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(pixel, size))) {
        ivec2 first = ivec2(gl_LocalInvocationID.xy);
        int own = (first.y + side / 2) * tile + first.x + side / 2;
        vec4 center = values[own];
        vec3 position = positions[own].xyz;
        vec3 normal = normals[own].xyz;
        vec3 plane = texelFetch(geometric_normal_occlusion, pixel, 0).xyz;
        precise vec4 sum = vec4(0);
        for (int y = 0; y <= side; ++y) {
            for (int x = 0; x <= side; ++x) {
                // Places of the pattern that are met at both ends count half at each, so that the mean is not displaced.
                float part = (x % side == 0 ? 0.5 : 1.0) * (y % side == 0 ? 0.5 : 1.0);
                int i = (first.y + y) * tile + first.x + x;
                precise float away = abs(inner(plane, positions[i].xyz - position)) / push.reach;
                precise float alike = (inner(normal, normals[i].xyz) - least_cosine) / (1.0 - least_cosine);
                precise float weight = part * values[i].a * clamp(alike, 0.0, 1.0) * max(1.0 - away, 0.0);
                sum += vec4(values[i].rgb, 1) * weight;
            }
        }
        vec3 mean = center.a > 0.0 && sum.a > 1e-3 ? sum.rgb / sum.a : center.rgb;
        imageStore(smoothed, pixel, vec4(mean, 1));
    }
}
