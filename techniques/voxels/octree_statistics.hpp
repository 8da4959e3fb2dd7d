// How large a scene's octree is, without making it.
#pragma once

#include <cstdint>
#include <vector>

#include "techniques/voxels/voxels.hpp"

namespace lumo::voxels {

/// Counts the nodes and voxels of a scene's octree from marks alone, and waits for that. Errors: those of the device.
Result<OctreeSize> count_octree(rhi::Device& device, const scene::GeometryView& geometry, uint32_t resolution,
                                VoxelizerKind voxelizer);

/// The figures of the paper's table 2.
struct OctreeStatistics {
    OctreeSize size;
    std::vector<uint64_t> occupied = {};  ///< voxels of each level, from the finest
    uint64_t fragments = 0;               ///< that the voxelizer made; several may share a voxel

    uint64_t brick_voxels = 0;   ///< texels of all bricks, borders included, one direction
    uint64_t light_texels = 0;   ///< … with the directions of anisotropic mips
    uint64_t node_bytes = 0;     ///< of what finds bricks: bits, ranks and records
    uint64_t marks_bytes = 0;    ///< of the occupancy that nodes are made from
    uint64_t surface_cells = 0;  ///< of the list of occupied voxels
    /// As the paper counts: all eight children of a node that is split, down to nodes of two voxels a side.
    uint64_t paper_nodes = 0;
};

/// Needs marks and their prefix sums, at most 0.3 bytes per voxel of the grid, and no pool. Errors: those of the
/// device.
Result<OctreeStatistics> octree_statistics(rhi::Device& device, const scene::GeometryView& geometry,
                                           uint32_t resolution, VoxelizerKind voxelizer);

}  // namespace lumo::voxels
