// Where the surfaces of an octree's occupied voxels are kept: a list, in volumes of cells_a_row x cells_a_row x n texels.
// The includer defines OCTREE_NODES and OCTREE_RECORDS, bindings.
#include "voxels/octree.glsl"

// A node of level 0.
struct NodeRecord {
    uint low;          // which voxels are occupied, as voxels/occupancy.glsl: z 0 and 1 of the node
    uint high;         // z 2 and 3
    uint first_voxel;  // place of its first occupied voxel in the list
};

layout(binding = OCTREE_NODES) uniform usampler3D octree_nodes;
layout(binding = OCTREE_RECORDS, std430) readonly buffer Records { NodeRecord data[]; } records;

ivec3 cell_of_place(uint place) { return ivec3(uvec3(place, place >> 8, place >> 16) & uvec3(255u, 255u, ~0u)); }

// The voxel's cell; negative where the voxel is empty. The voxel lies inside the grid.
ivec3 cell_of_voxel(ivec3 voxel) {
    int slot = node_slot(octree_nodes, voxel >> 2, 0);
    ivec3 cell = ivec3(-1);
    if (slot >= 0) {
        NodeRecord node = records.data[slot];
        bool in_high = (voxel.z & 2) != 0;
        uint word = in_high ? node.high : node.low;
        uint bit = 1u << occupancy_bit(voxel);
        uint before = uint(bitCount(word & (bit - 1u)) + (in_high ? bitCount(node.low) : 0));
        if ((word & bit) != 0u) cell = cell_of_place(node.first_voxel + before);
    }
    return cell;
}
