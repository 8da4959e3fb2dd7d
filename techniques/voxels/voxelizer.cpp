#include "techniques/voxels/voxelizer.hpp"

namespace lumo::voxels {

std::string_view to_string(VoxelizerKind kind) {
    return kind == VoxelizerKind::raster ? "raster" : "compute";
}

uint64_t count_triangles(const scene::GeometryView& geometry) {
    uint64_t triangles = 0;
    for (const scene::DrawView& draw : geometry.draws)
        triangles += uint64_t(draw.index_count / 3) * draw.instances;
    return triangles;
}

rhi::Groups triangle_groups(uint32_t triangles) {
    const uint32_t groups = rhi::groups_for(triangles, 64);
    const uint32_t rows = rhi::groups_for(groups, 65535);
    return {rhi::groups_for(groups, std::max(rows, 1u)), rows};
}

}  // namespace lumo::voxels
