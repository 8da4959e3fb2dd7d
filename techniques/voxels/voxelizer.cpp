#include "techniques/voxels/voxelizer.hpp"

#include <algorithm>

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

rhi::Groups triangle_groups(uint32_t triangles, uint32_t instances) {
    constexpr uint32_t most = 65535;
    return {std::min(rhi::groups_for(triangles, 64), most), std::min(instances, most),
            rhi::groups_for(instances, most)};
}

}  // namespace lumo::voxels
