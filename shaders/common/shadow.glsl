// The part of a directional light that reaches a point, from its shadow map. The includer defines SHADOW (see
// shadow_block.glsl) and SHADOW_MAP, the binding of its depth.
#include "common/shadow_block.glsl"

layout(binding = SHADOW_MAP) uniform sampler2D shadow_map;

// 0 in shadow to 1 in light: 3 x 3 comparisons weighted by a box of two texels about the point, which makes the
// result continuous. Beside the map nothing casts.
//
// The map's depth is unbiased, so that others can take positions from it. The receiver is moved along its normal
// instead. A tap d away in the light's plane sees a plane at angle t to it d tan t nearer; moving by o along the
// normal gains o / cos t; so o = d sin t is exactly enough, and d is at most 1.5 texels along each axis.
float sun_visibility(vec3 position, vec3 normal) {
    float cosine = clamp(dot(normal, shadow.direction.xyz), -1, 1);
    vec3 receiver = position + normal * (shadow.normal_offset * sqrt(1 - cosine * cosine));
    vec4 clip = transform(shadow.clip_from_world, vec4(receiver, 1));
    vec2 texel = (0.5 * clip.xy + 0.5) * shadow.size;
    float depth = clip.z - shadow.depth_offset;

    // The box covers part of the first row of texels, all of the second and the rest of the third.
    vec2 corner = floor(texel);
    vec2 f = texel - corner;
    vec3 weight_x = vec3(1 - f.x, 1, f.x);
    vec3 weight_y = vec3(1 - f.y, 1, f.y);
    ivec2 first = ivec2(corner) - 1;
    ivec2 last_texel = ivec2(int(shadow.size) - 1);
    float sum = 0;
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) {
            ivec2 at = first + ivec2(x, y);
            bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThanEqual(at, last_texel));
            float occluder = inside ? texelFetch(shadow_map, at, 0).x : 1.0;
            sum += weight_x[x] * weight_y[y] * (depth <= occluder ? 1.0 : 0.0);
        }
    }
    return 0.25 * sum;
}
