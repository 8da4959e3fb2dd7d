// Bricks of level 0 from the list of voxels: a word of nodes a group, a texel a thread.
#include "common/voxel_grid.glsl"
#define OCTREE_NODES 0
#define OCTREE_RECORDS 1
#include "voxels/octree_cells.glsl"

layout(local_size_x = 5, local_size_y = 5, local_size_z = 5) in;

layout(binding = 2) uniform sampler3D cells;
layout(binding = 3) writeonly uniform image3D bricks;

void main() {
    ivec3 texel = ivec3(gl_LocalInvocationID);
    ivec3 word = ivec3(gl_WorkGroupID);
    uvec2 nodes = texelFetch(octree_nodes, word, 0).xy;
    int slot = int(nodes.y);
    for (uint rest = nodes.x; rest != 0u; rest &= rest - 1u) {
        ivec3 voxel = node_of_bit(word, findLSB(rest)) * brick_voxels + texel;
        vec4 value = vec4(0);
        if (inside_grid(voxel, octree_side(0))) {
            ivec3 cell = listed_cell(voxel);
            if (cell.x >= 0) value = texelFetch(cells, cell, 0);
        }
        imageStore(bricks, brick_texel(slot, 0) + texel, value);
        ++slot;
    }
}
