#include "techniques/voxels/occupancy.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numeric>

#include "rhi/keep.hpp"

namespace lumo::voxels {

using rhi::Dimension;

Marks::Raster::Bindings Marks::raster(const DrawSources& draw) const {
    return {.vertices = draw.vertices,
            .indices = draw.indices,
            .instances = draw.instances,
            .material = draw.material,
            .base_color_texture = draw.base_color_texture,
            .marks = marks,
            .fragments = fragments};
}

Result<Voxelizer<Marks>> create_marker(rhi::Device& device, VoxelizerKind kind, const VoxelizerNeeds& needs,
                                       bool count_fragments) {
    return Voxelizer<Marks>::create(device, kind, needs, [&]<rhi::Program P>(bool alpha_test) {
        return typename P::Options{.alpha_test = alpha_test, .count_fragments = count_fragments};
    });
}

uint32_t OctreeSize::coarse_nodes() const {
    return nodes.empty() ? 0 : std::accumulate(nodes.begin() + 1, nodes.end(), 0u);
}

Result<Occupancy> Occupancy::create(rhi::Device& device, uint32_t resolution) {
    Occupancy made;
    made.levels_ = uint32_t(std::countr_zero(resolution));
    const rhi::Extent extent{resolution / 4, resolution / 4, resolution / 2};
    Result<void> done =
        device
            .create_texture({.name = "octree.occupancy",
                             .dimension = Dimension::d3,
                             .format = rhi::Format::r32_uint,
                             .extent = extent,
                             .mips = rhi::full_mips(extent),
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
            .map(keep(made.bits_));
    const uint64_t words = made.word_count();
    const uint64_t blocks = rhi::groups_for(uint32_t(words), scan_block);
    struct Wanted {
        rhi::Buffer* buffer;
        const char* name;
        uint64_t bytes;
    };
    for (const Wanted& w :
         {Wanted{&made.node_bits_, "octree.node_bits", 4 * words},
          Wanted{&made.counts_, "octree.counts", 8 * words},
          Wanted{&made.totals_, "octree.totals", 8 * blocks}, Wanted{&made.sum_, "octree.sum", 8}}) {
        if (done) done = device.create_buffer({.name = w.name, .size = w.bytes}).map(keep(*w.buffer));
    }
    if (done) {
        done = device
                   .create_sampler(
                       {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                   .map(keep(made.point_sampler_));
    }
    if (done) {
        done = device.create_compute_pipeline<shaders::voxels::octree_coarsen>().map(keep(made.coarsen_));
    }
    if (done) {
        done = device
                   .create_compute_pipeline<shaders::voxels::octree_nodes>(
                       {.octree_levels = int32_t(made.levels_)})
                   .map(keep(made.nodes_));
    }
    if (done) done = device.create_compute_pipeline<shaders::voxels::octree_scan>().map(keep(made.scan_));
    return done.map([&] { return std::move(made); });
}

rhi::Extent Occupancy::words(uint32_t level) const {
    const uint32_t side = 1u << levels_;
    return rhi::mip_extent({side / 16, side / 16, side / 8}, level);
}

uint32_t Occupancy::first_word(uint32_t level) const {
    uint32_t first = 0;
    for (uint32_t coarser = level + 1; coarser < node_levels(); ++coarser) {
        const rhi::Extent extent = words(coarser);
        first += extent.width * extent.height * extent.depth;
    }
    return first;
}

uint32_t Occupancy::word_count() const {
    const rhi::Extent finest = words(0);
    return first_word(0) + finest.width * finest.height * finest.depth;
}

rhi::Sampled<Dimension::d3, rhi::TexelKind::uint> Occupancy::sampled_bits() const {
    return {bits_.view<Dimension::d3>(), point_sampler_};
}

void Occupancy::clear(rhi::Commands& commands) {
    commands.pass("octree.clear").clear(marks(), std::array<uint32_t, 4>{});
}

void Occupancy::record(rhi::Commands& commands) {
    rhi::Pass pass = commands.pass("octree.nodes");
    const auto groups = [](const rhi::Extent& extent) { return rhi::groups_for(extent, {4, 4, 4}); };
    for (uint32_t level = 1; level < bits_.desc().mips; ++level) {
        pass.dispatch(
            coarsen_,
            {.finer = bits_.mip<Dimension::d3>(level - 1), .coarser = bits_.mip<Dimension::d3>(level)}, {},
            groups(rhi::mip_extent(bits_.desc().extent, level)));
    }
    for (uint32_t level = 0; level < node_levels(); ++level) {
        rhi::Groups level_groups = groups(words(level));
        pass.dispatch(
            nodes_, {.occupancy = sampled_bits(), .node_bits = node_bits_.slice(), .counts = counts_.slice()},
            {.level = int32_t(level), .first_word = int32_t(first_word(level))}, level_groups);
    }
    const uint32_t count = word_count();
    const uint32_t blocks = rhi::groups_for(count, scan_block);
    pass.dispatch(scan_, {.sums = counts_.slice(), .totals = totals_.slice()},
                  {.count = count, .block = scan_block}, {blocks});
    pass.dispatch(scan_, {.sums = totals_.slice(), .totals = sum_.slice()},
                  {.count = blocks, .block = rhi::groups_for(blocks, 256) * 256}, {1});
}

Result<OctreeSize> Occupancy::size(rhi::Device& device) const {
    using Pair = std::array<uint32_t, 2>;
    const auto read = [&](const rhi::Buffer& buffer) {
        return device.download(buffer.slice()).map([](const std::vector<std::byte>& bytes) {
            std::vector<Pair> pairs(bytes.size() / sizeof(Pair));
            std::memcpy(pairs.data(), bytes.data(), bytes.size());
            return pairs;
        });
    };
    Result<std::vector<Pair>> counts = read(counts_);
    if (!counts) return tl::unexpected(counts.error());
    Result<std::vector<Pair>> totals = read(totals_);
    if (!totals) return tl::unexpected(totals.error());
    Result<std::vector<Pair>> sum = read(sum_);
    if (!sum) return tl::unexpected(sum.error());

    OctreeSize size{.nodes = std::vector<uint32_t>(levels_ + 1, 1), .voxels = sum->front()[1]};
    uint32_t after = sum->front()[0];
    for (uint32_t level = 0; level < node_levels(); ++level) {
        const uint32_t first = first_word(level);
        const uint32_t before = (*counts)[first][0] + (*totals)[first / scan_block][0];
        size.nodes[level] = after - before;
        after = before;
    }
    return size;
}

}  // namespace lumo::voxels
