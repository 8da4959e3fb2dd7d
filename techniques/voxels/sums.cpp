#include "techniques/voxels/sums.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "rhi/keep.hpp"

namespace lumo::voxels {
namespace {

using rhi::Dimension;
using rhi::Format;

/// sum_words of shaders/voxels/accumulator.glsl, of surfaces or of emission.
uint32_t sum_words(const SumsSettings& settings, bool emission) {
    const uint32_t value = !is_order_free(settings.range)               ? 0
                           : settings.range == Range::fixed && emission ? 6
                                                                        : 3;
    return 1 + value + (settings.normals ? 3 : 0) + (settings.translucent ? 1 : 0);
}

rhi::View<Dimension::d3> view(const rhi::Texture& texture) { return texture.mip<Dimension::d3>(0); }

constexpr const char* pass_names[2][2] = {{"voxels.clear", "voxels.voxelize"},
                                          {"voxels.clear_emission", "voxels.voxelize_emission"}};

/// What all voxelizers of sums bind first, by ascending binding numbers, and what else they bind.
template <class Bindings, class... Rest>
Bindings bindings_of(const DrawSources& draw, rhi::View<Dimension::d3> sums, Rest... rest) {
    return {draw.vertices,           draw.indices,          draw.instances, draw.material,
            draw.base_color_texture, draw.emission_texture, sums,           rest...};
}

}  // namespace

AddedSums::Raster::Bindings AddedSums::raster(const DrawSources& draw) const {
    return bindings_of<Raster::Bindings>(draw, sums, lookup.octree_nodes, lookup.records, lookup.block_marks);
}

template <class P>
typename P::Bindings AddedSums::compute(const DrawSources& draw, const LargeTriangles& large) const {
    return bindings_of<typename P::Bindings>(draw, sums, large.arguments, large.list, lookup.octree_nodes,
                                             lookup.records, lookup.block_marks);
}

ExchangedSums::Raster::Bindings ExchangedSums::raster(const DrawSources& draw) const {
    return bindings_of<Raster::Bindings>(draw, sums, lookup.octree_nodes, lookup.records, exchanged, floats,
                                         dropped, lookup.block_marks);
}

template <class P>
typename P::Bindings ExchangedSums::compute(const DrawSources& draw, const LargeTriangles& large) const {
    return bindings_of<typename P::Bindings>(draw, sums, large.arguments, large.list, lookup.octree_nodes,
                                             lookup.records, exchanged, floats, dropped, lookup.block_marks);
}

Result<Sums> Sums::create(rhi::Device& device, const SumsSettings& settings, const VoxelizerNeeds& needs,
                          rhi::Extent cells) {
    Sums sums;
    sums.settings_ = settings;
    return sums.create_textures(device, cells)
        .and_then([&] { return sums.create_voxelizers(device, needs); })
        .map([&] { return std::move(sums); });
}

uint32_t Sums::texels_a_cell() const {
    return std::max(sum_words(settings_, false), settings_.emission ? sum_words(settings_, true) : 0);
}

Result<void> Sums::create_textures(rhi::Device& device, rhi::Extent cells) {
    const uint32_t words = texels_a_cell();
    const uint32_t widest_volume = settings_.range == Range::mutex ? std::max(words, 4u) : words;
    const uint32_t widest = device.info().limits.max_texture_side_3d;
    if (cells.width * widest_volume > widest) {
        return fail(ErrorKind::limit, "--voxels",
                    fmt::format("{} voxels a side need a volume {} texels wide, and this device's end at {}",
                                cells.width, cells.width * widest_volume, widest),
                    fmt::format("use at most {}, or --storage svo", widest / widest_volume));
    }
    const auto texture = [&](const char* name, Format format, rhi::Extent extent, rhi::Texture& place) {
        return device
            .create_texture({.name = name,
                             .dimension = Dimension::d3,
                             .format = format,
                             .extent = extent,
                             .usage = rhi::TextureUsage::storage})
            .map([&](rhi::Texture made) {
                place = std::move(made);
                empty_volumes(device, {&place});
            });
    };
    const bool exchanges = !is_order_free(settings_.range);
    const rhi::Extent extent{cells.width * words, cells.height, cells.depth};
    return texture("voxels.sums", Format::r32_uint, extent, sums_[0])
        .and_then([&]() -> Result<void> {
            if (!settings_.keep || !settings_.emission) return {};
            return texture("voxels.emission_sums", Format::r32_uint, extent, sums_[1]);
        })
        .and_then([&] {
            return texture("voxels.exchanged", Format::r32_uint, exchanges ? cells : rhi::Extent{},
                           exchanged_);
        })
        .and_then([&] {
            return texture("voxels.floats", Format::r32_uint,
                           settings_.range == Range::mutex
                               ? rhi::Extent{cells.width * 4, cells.height, cells.depth}
                               : rhi::Extent{},
                           floats_);
        })
        .and_then([&] { return device.create_buffer({.name = "voxels.dropped", .size = 4}); })
        .map(keep(dropped_));
}

Result<void> Sums::create_voxelizers(rhi::Device& device, const VoxelizerNeeds& needs) {
    Result<void> made;
    for (const bool emission : {false, true}) {
        if (!made || (emission && !settings_.emission)) continue;
        const auto options = [&]<rhi::Program P>(bool alpha_test) {
            return typename P::Options{.alpha_test = alpha_test,
                                       .emission = emission,
                                       .translucent = settings_.translucent,
                                       .normals = settings_.normals,
                                       .range = int32_t(settings_.range),
                                       .octree_levels = settings_.octree_levels};
        };
        const auto create = [&]<class Destination>(std::optional<Voxelizer<Destination>>& place) {
            return Voxelizer<Destination>::create(device, settings_.voxelizer, needs, options)
                .map(keep(place));
        };
        made = is_order_free(settings_.range) ? create(added_[emission]) : create(exchanged_by_[emission]);
    }
    return made;
}

void Sums::clear(rhi::Pass& pass, const Blocks* listed, bool emission) const {
    const auto empty = [&](const rhi::Texture& volume, uint32_t words) {
        if (listed) {
            listed->clear(pass, volume, words);
        } else {
            pass.clear(volume.view(), std::array<uint32_t, 4>{});
        }
    };
    empty(sums(emission), texels_a_cell());
    if (!is_order_free(settings_.range)) empty(exchanged_, 1);
    if (settings_.range == Range::mutex) empty(floats_, 4);
}

template <class Wanted>
void Sums::add(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
               const CellLookup& lookup, const Blocks* listed, bool emission, float scale,
               const Wanted& wanted) {
    const auto [clear_name, name] = pass_names[emission];
    {
        rhi::Pass pass = commands.pass(clear_name);
        clear(pass, listed, emission);
        if (!emission) pass.fill(dropped());
    }
    if (added_[emission]) {
        added_[emission]->record(commands, name, geometry, grid, {view(sums(emission)), lookup}, scale,
                                 wanted);
    } else {
        exchanged_by_[emission]->record(
            commands, name, geometry, grid,
            {view(sums(emission)), view(exchanged_), view(floats_), dropped(), lookup}, scale, wanted);
    }
}

void Sums::move(rhi::Commands& commands, const scene::GeometryView& before, const scene::GeometryView& after,
                std::span<const uint32_t> draws, const Grid& grid, const CellLookup& lookup, bool emission,
                float scale) {
    const auto record = [&](const scene::GeometryView& geometry, Sign sign) {
        const auto moved = [&](const scene::DrawView& draw) {
            const auto index = uint32_t(&draw - geometry.draws.data());
            return std::ranges::find(draws, index) != draws.end() && (!emission || draw.emits);
        };
        added_[emission]->record(commands, "voxels.move", geometry, grid, {view(sums(emission)), lookup},
                                 scale, moved, sign);
    };
    record(before, Sign::subtract);
    record(after, Sign::add);
}

void Sums::add_surfaces(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
                        const CellLookup& lookup, const Blocks* listed) {
    add(commands, geometry, grid, lookup, listed, false, 0, [](const scene::DrawView&) { return true; });
}

void Sums::add_emission(rhi::Commands& commands, const scene::GeometryView& geometry, const Grid& grid,
                        const CellLookup& lookup, const Blocks* listed, float scale) {
    add(commands, geometry, grid, lookup, listed, true, scale,
        [](const scene::DrawView& draw) { return draw.emits; });
}

}  // namespace lumo::voxels
