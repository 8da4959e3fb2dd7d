// Which surfaces the sun reaches, counted in texels of the shadow map.
//
// Every texel carries the same flux, irradiance times texel area, to the point that it sees, however that surface
// is inclined. So a voxel's count, an integer and hence the same in any order, gives the flux that falls on it.
#include "common/voxel_grid.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(push_constant) uniform Push {
    mat4 world_from_light_clip;
    vec3 grid_origin;
    float voxels_per_metre;
    vec3 direction_to_sun;  // unit length
} push;

layout(binding = 0) uniform sampler2D shadow_depth;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, r32ui) uniform uimage3D lit_texels;

bool count_at(vec3 position) {
    ivec3 voxel = ivec3(floor(position));
    if (!inside_grid(voxel, imageSize(area).x) || imageLoad(area, voxel).r == 0.0) return false;
    imageAtomicAdd(lit_texels, voxel, 1u);
    return true;
}

void main() {
    ivec2 size = textureSize(shadow_depth, 0);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size))) return;
    float depth = texelFetch(shadow_depth, texel, 0).r;
    if (depth == 1.0) return;

    // Term by term and `precise`: which voxel a texel falls into must not hang on how a compiler orders a product.
    precise vec2 ndc = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
    mat4 m = push.world_from_light_clip;
    precise vec3 world = m[0].xyz * ndc.x + m[1].xyz * ndc.y + m[2].xyz * depth + m[3].xyz;
    precise vec3 position = (world - push.grid_origin) * push.voxels_per_metre;

    // The part of a surface that cuts a voxel's corner may meet none of its centre lines, and a surface on a face may
    // have been voxelized to the other side of it. Its light goes to the nearest voxel that the surface does mark:
    // across the nearest face, the next, the last.
    if (count_at(position)) return;
    vec3 offset = fract(position) - 0.5;
    vec3 nearness = abs(offset);
    for (int i = 0; i < 3; ++i) {
        float nearest = max(nearness.x, max(nearness.y, nearness.z));
        bvec3 across = nearness.x == nearest   ? bvec3(true, false, false)
                       : nearness.y == nearest ? bvec3(false, true, false)
                                               : bvec3(false, false, true);
        if (count_at(position + sign(offset) * vec3(across))) return;
        nearness = mix(nearness, vec3(-1), across);
    }
}
