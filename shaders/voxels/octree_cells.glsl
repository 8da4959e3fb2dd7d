// Where a voxel's surfaces are kept. In a dense volume a voxel is its own cell. In an octree there is a list of the
// occupied voxels, in the cells of octree.glsl. The includer defines OCTREE_NODES and OCTREE_RECORDS, bindings.
#include "voxels/octree.glsl"

// A node of level 0.
struct NodeRecord {
    uint low;          // which voxels are occupied, as voxels/occupancy.glsl: z 0 and 1 of the node
    uint high;         // z 2 and 3
    uint first_voxel;  // place of its first occupied voxel in the list
};

layout(binding = OCTREE_NODES) uniform usampler3D octree_nodes;
layout(binding = OCTREE_RECORDS, std430) readonly buffer Records { NodeRecord data[]; } records;

// The octree's cell of a voxel; negative where the voxel is empty. The voxel lies inside the grid.
ivec3 listed_cell(ivec3 voxel) {
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

// As listed_cell, of either storage; an empty voxel of a dense volume has a cell too.
ivec3 cell_of_voxel(ivec3 voxel) { return octree_levels > 0 ? listed_cell(voxel) : voxel; }
