// A fragment of a voxelized surface, and what its voxel is given. The includer defines MATERIAL, BASE_COLOR_TEXTURE and
// what a destination needs:
//   - MARKS and FRAGMENTS, bindings: voxels are marked in an occupancy volume (voxels/occupancy.glsl), and nothing else
//     is evaluated than whether the fragment is there; where asked for, fragments are counted;
//   - or EMISSION_TEXTURE, a binding, those of voxels/accumulate.glsl, and those of voxels/octree_cells.glsl, which says
//     where in the accumulator a voxel has its sums; and BLOCK_MARKS, a binding: which blocks of a dense volume hold
//     something (voxels/block_list.glsl).

#include "common/voxel_grid.glsl"
#include "common/material.glsl"
#include "voxels/voxelize_push.glsl"

layout(constant_id = 0) const bool alpha_test = false;

struct VoxelFragment {
    ivec3 voxel;        // inside the grid
    float share;        // surface area that the fragment stands for, in voxel faces
    vec2 uv0;
    vec2 uv1;
    vec4 color;         // the vertices'
    vec2 uv_per_voxel;  // length of one voxel in each uv set
    vec3 facing;        // unit normal of the front side
    uint seed;          // another for every fragment
};

uint fragment_seed(uint triangle, int axis, ivec2 column) {
    return (triangle * 3u + uint(axis)) * 747796405u ^ uint(column.x) * 2891336453u ^ uint(column.y) * 277803737u;
}

// The mip whose texels are as large as a voxel.
float texel_lod(VoxelFragment f, uint role, ivec2 size) {
    vec2 side = f.uv_per_voxel * sqrt(float(size.x) * float(size.y));
    bool second_set = (material.flags >> role & 1u) != 0u;
    return log2(max(second_set ? side.y : side.x, 1.0));
}

vec4 base_color_of(VoxelFragment f) {
    return material_base_color_lod(f.uv0, f.uv1, f.color,
                                   texel_lod(f, role_base_color, textureSize(base_color_texture, 0)));
}

#ifdef MARKS
#include "voxels/occupancy.glsl"

layout(constant_id = 5) const bool count_fragments = false;

layout(binding = MARKS, r32ui) uniform uimage3D marks;
layout(binding = FRAGMENTS, std430) buffer Fragments { uint count; } fragments;

void keep_fragment(VoxelFragment f) {
    if (alpha_test && base_color_of(f).a < material.alpha_cutoff) return;
    imageAtomicOr(marks, occupancy_texel(f.voxel), 1u << occupancy_bit(f.voxel));
    if (count_fragments) atomicAdd(fragments.count, 1u);
}
#else
#include "voxels/accumulate.glsl"
#include "voxels/octree_cells.glsl"

layout(binding = BLOCK_MARKS, std430) buffer BlockMarks { uint data[]; } block_marks;

void mark_block(ivec3 voxel) {
    ivec3 block = voxel >> 2;
    int side = int(push.resolution) >> 2;
    atomicOr(block_marks.data[(block.z * side + block.y) * side + block.x], 1u);
}

void keep_fragment(VoxelFragment f) {
    vec4 base = base_color_of(f);
    if (alpha_test && base.a < material.alpha_cutoff) return;
    ivec3 cell = cell_of_voxel(f.voxel);
    // The octree has no room for it.
    if (cell.x < 0) return;
    if (octree_levels == 0) mark_block(f.voxel);
    // At least 1, so that a fragment of any slope marks its voxel.
    float weight = max(floor(f.share * weight_unit + 0.5), 1.0);
    vec3 value = base.rgb;
    if (emission) {
        value = push.emission_scale *
                material_emission_lod(f.uv0, f.uv1, texel_lod(f, role_emission, textureSize(emission_texture, 0)));
    }
    add_value(cell, value, weight, f.seed);
    add(cell, word_weight, weight);
    if (normals && !emission) add_color(cell, word_normal, f.facing * 0.5 + 0.5, weight);
    if (translucent && !emission) {
        // What alpha cut out is opaque where it was left.
        float opacity = material.alpha_cutoff > 0.0 ? 1.0 : clamp(base.a, 0.0, 1.0);
        add(cell, word_opacity, floor(opacity * weight + 0.5));
    }
}
#endif
