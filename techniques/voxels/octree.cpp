#include "techniques/voxels/octree.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "rhi/keep.hpp"

namespace lumo::voxels {
namespace {

using rhi::Dimension;
using rhi::Format;

/// Cells of the list lie in squares of this side: many texels a cell still fit into a row.
constexpr uint32_t cells_a_row = 128;

Format light_format(const OctreeSettings& settings) {
    return settings.wide_range ? Format::rgba16_float : Format::rgba8_unorm;
}

/// Texels of a pool, as brick_texel of shaders/voxels/octree.glsl places bricks.
rhi::Extent pool_extent(uint32_t bricks, uint32_t bricks_a_row, uint32_t directions) {
    const uint32_t squares = std::max(rhi::groups_for(bricks, bricks_a_row * bricks_a_row), 1u);
    return {directions * bricks_a_row * brick_side, bricks_a_row * brick_side, squares * brick_side};
}

rhi::TextureDesc volume(std::string name, Format format, rhi::Extent extent) {
    return {.name = std::move(name),
            .dimension = Dimension::d3,
            .format = format,
            .extent = extent,
            .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage};
}

}  // namespace

Result<Octree> Octree::create(rhi::Device& device, const OctreeSettings& settings, const OctreeSize& size) {
    Octree made;
    made.settings_ = settings;
    made.size_ = size;
    made.cell_extent_ = {cells_a_row, cells_a_row,
                         std::max(rhi::groups_for(size.voxels, cells_a_row * cells_a_row), 1u)};
    Result<void> done = Occupancy::create(device, settings.resolution).map(keep(made.occupancy_));
    if (done) {
        rhi::TextureDesc nodes = volume("octree.nodes", Format::rg32_uint, made.occupancy_.words(0));
        nodes.mips = made.occupancy_.node_levels();
        done = device.create_texture(nodes).map(keep(made.nodes_));
    }
    if (done) {
        done = device.create_texture(volume("octree.cells", light_format(settings), made.cell_extent_))
                   .map(keep(made.cells_));
    }
    const uint64_t records = std::max<uint64_t>(size.fine_nodes(), 1);
    const uint64_t listed = settings.list_voxels ? std::max<uint64_t>(size.voxels, 1) : 1;
    if (done) {
        done =
            device.create_buffer({.name = "octree.records", .size = 12 * records}).map(keep(made.records_));
    }
    if (done)
        done = device.create_buffer({.name = "octree.voxels", .size = 4 * listed}).map(keep(made.voxels_));
    if (done) done = made.create_pipelines(device);
    return done.map([&] { return std::move(made); });
}

Result<void> Octree::create_pipelines(rhi::Device& device) {
    const auto levels_log2 = int32_t(levels());
    Result<void> done = device
                            .create_compute_pipeline<shaders::voxels::octree_index>(
                                {.list_voxels = settings_.list_voxels, .octree_levels = levels_log2})
                            .map(keep(index_));
    if (done) {
        done = device.create_compute_pipeline<shaders::voxels::octree_fill>({.octree_levels = levels_log2})
                   .map(keep(fill_));
    }
    for (const bool from_fine : {false, true}) {
        const auto create_mip = [&]<class P>(rhi::ComputePipeline<P>& pipeline) {
            return device
                .create_compute_pipeline<P>({.from_fine = from_fine,
                                             .anisotropic = settings_.mips == MipKind::anisotropic,
                                             .octree_levels = levels_log2})
                .map(keep(pipeline));
        };
        if (done)
            done = settings_.wide_range ? create_mip(mip_wide_[from_fine]) : create_mip(mip_[from_fine]);
    }
    return done;
}

void Octree::index(rhi::Commands& commands) {
    rhi::Pass pass = commands.pass("octree.index");
    for (uint32_t level = 0; level < occupancy_.node_levels(); ++level) {
        const rhi::Extent words = occupancy_.words(level);
        pass.dispatch(index_,
                      {.node_bits = occupancy_.node_bits(),
                       .counts = occupancy_.counts(),
                       .totals = occupancy_.totals(),
                       .occupancy = occupancy_.sampled_bits(),
                       .nodes = nodes_.mip<Dimension::d3>(level),
                       .records = records_.slice(),
                       .voxels = voxels_.slice()},
                      {.level = int32_t(level),
                       .first_word = int32_t(occupancy_.first_word(level)),
                       .first_fine_word = int32_t(occupancy_.first_word(0)),
                       .block = int32_t(Occupancy::scan_block),
                       .most_nodes = int32_t(level == 0 ? size_.fine_nodes() : size_.coarse_nodes()),
                       .most_voxels = int32_t(size_.voxels)},
                      rhi::groups_for(words, {4, 4, 4}));
    }
}

Result<LightVolume> Octree::create_light(rhi::Device& device, const std::string& name) const {
    const uint32_t directions = settings_.mips == MipKind::anisotropic ? 6 : 1;
    const rhi::TextureDesc descs[] = {
        volume(name, light_format(settings_), pool_extent(size_.fine_nodes(), settings_.resolution / 8, 1)),
        volume(name + ".coarse", light_format(settings_),
               pool_extent(size_.coarse_nodes(), settings_.resolution / 16, directions))};
    LightVolume light;
    rhi::Texture* const textures[] = {&light.base, &light.directions};
    const uint32_t widest = device.info().limits.max_texture_side_3d;
    for (size_t i = 0; i < std::size(descs); ++i) {
        const rhi::Extent& extent = descs[i].extent;
        const uint32_t side = std::max({extent.width, extent.height, extent.depth});
        if (side > widest) {
            return fail(
                ErrorKind::limit, "--voxels",
                fmt::format("an octree of {} voxels a side over this scene needs a brick pool {} texels "
                            "long, and this device's volumes end at {}",
                            settings_.resolution, side, widest),
                fmt::format("use at most {}", settings_.resolution / 2));
        }
        Result<rhi::Texture> made = device.create_texture(descs[i]);
        if (!made) return tl::unexpected(made.error());
        *textures[i] = std::move(*made);
    }
    return light;
}

void Octree::fill(rhi::Pass& pass, const LightVolume& light) const {
    const auto groups = [&](uint32_t level) {
        const rhi::Extent words = level < occupancy_.node_levels() ? occupancy_.words(level) : rhi::Extent{};
        return rhi::Groups{words.width, words.height, words.depth};
    };
    pass.dispatch(fill_,
                  {.octree_nodes = nodes(),
                   .records = records_.slice(),
                   .cells = {cells_.view<Dimension::d3>(), occupancy_.point_sampler()},
                   .bricks = light.base.mip<Dimension::d3>(0)},
                  {}, groups(0));
    for (uint32_t level = 1; level <= levels(); ++level) {
        const auto dispatch = [&]<class P>(const rhi::ComputePipeline<P>& pipeline) {
            pass.dispatch(pipeline,
                          {.nodes = nodes(),
                           .occupancy = occupancy_.sampled_bits(),
                           .fine = {light.base.view<Dimension::d3>(), occupancy_.point_sampler()},
                           .coarse = light.directions.mip<Dimension::d3>(0)},
                          {.level = int32_t(level)}, groups(level));
        };
        if (settings_.wide_range) {
            dispatch(mip_wide_[level == 1]);
        } else {
            dispatch(mip_[level == 1]);
        }
    }
}

rhi::Sampled<Dimension::d3, rhi::TexelKind::uint> Octree::nodes() const {
    return {nodes_.view<Dimension::d3>(), occupancy_.point_sampler()};
}

}  // namespace lumo::voxels
