#include "techniques/voxels/octree_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

namespace lumo::voxels {
namespace {

constexpr uint64_t brick_texels = uint64_t(brick_side) * brick_side * brick_side;

/// Marks a scene's voxels and derives its nodes; waits for it. `fragments`: where their number is added to a uint32_t,
/// if `count_fragments`.
Result<Occupancy> mark(rhi::Device& device, const scene::GeometryView& geometry, uint32_t resolution,
                       VoxelizerKind kind, const rhi::Buffer& fragments, bool count_fragments) {
    Result<Occupancy> occupancy = Occupancy::create(device, resolution);
    if (!occupancy) return occupancy;
    const bool masked = std::ranges::any_of(geometry.draws, [](const scene::DrawView& draw) {
        return draw.alpha_mode == scene::AlphaMode::mask;
    });
    const Result<Voxelizer<Marks>> marker = create_marker(device, kind,
                                                          {.alpha_mask = masked,
                                                           .triangles = count_triangles(geometry),
                                                           .draws = uint32_t(geometry.draws.size())},
                                                          count_fragments);
    if (!marker) return tl::unexpected(marker.error());
    rhi::Commands commands = device.begin();
    commands.pass("octree.fragments").fill(fragments.slice());
    occupancy->clear(commands);
    marker->record(commands, "octree.mark", geometry, fit_grid(geometry.bounds, resolution),
                   Marks{occupancy->marks(), fragments.slice()}, 0,
                   [](const scene::DrawView&) { return true; });
    occupancy->record(commands);
    return device.wait(device.submit(std::move(commands))).map([&] { return std::move(*occupancy); });
}

Result<uint64_t> count_bits(rhi::Device& device, const rhi::Texture& bits, uint32_t mip) {
    return device.download(bits, rhi::whole_mip(bits.desc(), mip))
        .map([](const std::vector<std::byte>& bytes) {
            uint64_t count = 0;
            for (size_t at = 0; at < bytes.size(); at += sizeof(uint32_t)) {
                uint32_t word = 0;
                std::memcpy(&word, bytes.data() + at, sizeof word);
                count += uint64_t(std::popcount(word));
            }
            return count;
        });
}

}  // namespace

Result<OctreeSize> count_octree(rhi::Device& device, const scene::GeometryView& geometry, uint32_t resolution,
                                VoxelizerKind voxelizer) {
    const Result<rhi::Buffer> fragments = device.create_buffer({.name = "octree.fragments", .size = 4});
    if (!fragments) return tl::unexpected(fragments.error());
    const Result<Occupancy> occupancy = mark(device, geometry, resolution, voxelizer, *fragments, false);
    if (!occupancy) return tl::unexpected(occupancy.error());
    return occupancy->size(device);
}

Result<OctreeStatistics> octree_statistics(rhi::Device& device, const scene::GeometryView& geometry,
                                           uint32_t resolution, VoxelizerKind voxelizer) {
    const Result<rhi::Buffer> fragments = device.create_buffer({.name = "octree.fragments", .size = 4});
    if (!fragments) return tl::unexpected(fragments.error());
    const Result<Occupancy> occupancy = mark(device, geometry, resolution, voxelizer, *fragments, true);
    if (!occupancy) return tl::unexpected(occupancy.error());
    Result<OctreeSize> size = occupancy->size(device);
    if (!size) return tl::unexpected(size.error());
    const Result<std::vector<std::byte>> counted = device.download(fragments->slice());
    if (!counted) return tl::unexpected(counted.error());
    uint32_t fragment_count = 0;
    std::memcpy(&fragment_count, counted->data(), sizeof fragment_count);

    OctreeStatistics statistics{.size = std::move(*size), .fragments = fragment_count};
    const rhi::Texture& bits = occupancy->bits();
    for (uint32_t mip = 0; mip < bits.desc().mips; ++mip) {
        const Result<uint64_t> count = count_bits(device, bits, mip);
        if (!count) return tl::unexpected(count.error());
        statistics.occupied.push_back(*count);
        statistics.marks_bytes += rhi::region_bytes(rhi::Format::r32_uint, rhi::whole_mip(bits.desc(), mip));
    }
    // The single voxel at the top.
    statistics.occupied.push_back(statistics.occupied.back() > 0);

    const uint64_t fine = statistics.size.fine_nodes(), coarse = statistics.size.coarse_nodes();
    statistics.brick_voxels = (fine + coarse) * brick_texels;
    statistics.light_texels = (fine + 6 * coarse) * brick_texels;
    statistics.surface_cells = statistics.size.voxels;
    uint64_t words = 0;
    for (uint32_t level = 0; level < occupancy->node_levels(); ++level) {
        const rhi::Extent extent = occupancy->words(level);
        words += uint64_t(extent.width) * extent.height * extent.depth;
    }
    statistics.node_bytes = 8 * words + 12 * fine;
    // A node of the paper's finest level has two voxels a side: every occupied cell above it is split.
    statistics.paper_nodes =
        1 + 8 * std::accumulate(statistics.occupied.begin() + 2, statistics.occupied.end(), uint64_t(0));
    return statistics;
}

}  // namespace lumo::voxels
