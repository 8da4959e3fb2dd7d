#include "common/voxel_grid.glsl"
#define MATERIAL 3
#define BASE_COLOR_TEXTURE 4
#define EMISSION_TEXTURE 5
#include "common/material.glsl"
#include "voxels/accumulator.glsl"
#include "voxels/voxelize_push.glsl"

layout(location = 0) in vec2 uv0;
layout(location = 1) in vec2 uv1;
layout(location = 2) in vec4 color;
layout(location = 3) flat in vec3 anchor;
layout(location = 4) flat in vec2 slope;
layout(location = 5) flat in uint axis;
layout(location = 6) flat in float share;
layout(location = 7) flat in vec2 uv_per_voxel;

layout(location = 8) flat in vec3 facing;

layout(constant_id = 0) const bool alpha_test = false;
layout(constant_id = 1) const bool emission = false;  // sums emission instead of base colour

layout(binding = 6, r32ui) uniform uimage3D sums;

void add(ivec3 voxel, int word, float value) {
    uint quantised = uint(value + 0.5);
    if (quantised != 0u) imageAtomicAdd(sums, sum_texel(voxel, word), quantised);
}

void add_color(ivec3 voxel, int first_word, vec3 color, float weight) {
    vec3 bits = floor(clamp(color, 0.0, 1.0) * 255.0 + 0.5);
    add(voxel, first_word, bits.r * weight);
    add(voxel, first_word + 1, bits.g * weight);
    add(voxel, first_word + 2, bits.b * weight);
}

// The mip whose texels are as large as a voxel.
float texel_lod(uint role, ivec2 size) {
    vec2 side = uv_per_voxel * sqrt(float(size.x) * float(size.y));
    bool second_set = (material.flags >> role & 1u) != 0u;
    return log2(max(second_set ? side.y : side.x, 1.0));
}

void main() {
    // From the fragment's own centre and flat plane data: the drivers' interpolants differ in the last bits.
    precise float height = anchor.z + dot(slope, gl_FragCoord.xy - anchor.xy);
    ivec3 voxel = ivec3(floor(vec3(gl_FragCoord.xy, height)));
    voxel = axis == 0u ? voxel.zxy : axis == 1u ? voxel.yzx : voxel;
    if (!inside_grid(voxel, int(push.resolution))) return;

    vec4 base = material_base_color_lod(uv0, uv1, color, texel_lod(role_base_color, textureSize(base_color_texture, 0)));
    if (alpha_test && base.a < material.alpha_cutoff) return;
    vec3 value = base.rgb;
    if (emission) {
        value = push.emission_scale *
                material_emission_lod(uv0, uv1, texel_lod(role_emission, textureSize(emission_texture, 0)));
    }

    // At least 1, so that a fragment of any slope marks its voxel.
    float weight = max(floor(share * weight_unit + 0.5), 1.0);
    add_color(voxel, word_color, value, weight);
    add(voxel, word_weight, weight);
    if (normals && !emission) add_color(voxel, word_normal, facing * 0.5 + 0.5, weight);
    if (translucent && !emission) add(voxel, word_opacity, floor(clamp(base.a, 0.0, 1.0) * weight + 0.5));
}
