// Bricks of one level from those of the next finer one, filtered as in a volume, to the bit: a word of nodes a group, a
// texel a thread. The includer defines FORMAT, the pool's.
//
// Anisotropic: the pool has a part for each direction, side by side along x.
#include "common/voxel_grid.glsl"
#include "voxels/octree.glsl"

layout(local_size_x = 5, local_size_y = 5, local_size_z = 5) in;

layout(constant_id = 0) const bool from_fine = false;   // from level 0, which has no directions
layout(constant_id = 23) const bool anisotropic = false;

layout(push_constant) uniform Push {
    int level;  // that is made
} push;

layout(binding = 0) uniform usampler3D nodes;
layout(binding = 1) uniform usampler3D occupancy;
layout(binding = 2) uniform sampler3D fine;
layout(binding = 3, FORMAT) LUMO_READ_WRITE uniform image3D coarse;

int direction_width() { return brick_side << bricks_a_row_log2(1); }

vec4 finer_texel(ivec3 texel, int direction) {
    if (from_fine) return texelFetch(fine, texel, 0);
    return imageLoad(coarse, texel + ivec3(direction * direction_width(), 0, 0));
}
#include "voxels/filter.glsl"

bool is_occupied(ivec3 voxel) {
    // The single voxel at the top has no occupancy of its own.
    if (push.level == octree_levels) return voxel == ivec3(0);
    return inside_grid(voxel, octree_side(push.level)) &&
           (texelFetch(occupancy, occupancy_texel(voxel), push.level).r >> occupancy_bit(voxel) & 1u) != 0u;
}

void main() {
    ivec3 texel = ivec3(gl_LocalInvocationID);
    ivec3 word = ivec3(gl_WorkGroupID);
    uint bits = 1u;
    int slot = octree_levels - push.level;
    if (slot > 2) {
        uvec2 found = texelFetch(nodes, word, push.level).xy;
        bits = found.x;
        slot = int(found.y);
    }
    for (; bits != 0u; bits &= bits - 1u) {
        ivec3 voxel = node_of_bit(word, findLSB(bits)) * brick_voxels + texel;
        ivec3 to = brick_texel(slot, push.level) + texel;
        ivec3 child = voxel * 2;
        int child_slot = is_occupied(voxel) ? node_slot(nodes, child >> 2, push.level - 1) : -1;
        ivec3 from = brick_texel(child_slot, push.level - 1) + (child & 3);
        for (int direction = 0; direction < (anisotropic ? 6 : 1); ++direction) {
            vec4 value = vec4(0);
            if (child_slot >= 0) value = anisotropic ? seen_along(direction, from) : mean_of(from);
            imageStore(coarse, to + ivec3(direction * direction_width(), 0, 0), value);
        }
        ++slot;
    }
}
