#include "techniques/cones/emitters.hpp"

#include <algorithm>

#include "rhi/keep.hpp"

namespace lumo::cones {
namespace {

using rhi::Dimension;

constexpr int coarsest = 8;  // cells a side
constexpr int most = 32;     // cells a side of the finest grid
constexpr int few = 16;      // emitters that are lit by one by one without a share for the other cones
constexpr uint64_t cell_bytes = 48;  // EmitterCell of shaders/cones/emitter_cell.glsl

rhi::Groups cell_groups(int side) {
    const uint32_t groups = rhi::groups_for(uint32_t(side), 4);
    return {groups, groups, groups};
}

}  // namespace

Result<Emitters> Emitters::create(rhi::Device& device, const voxels::Settings& volume) {
    Emitters made;
    made.finest_ = std::clamp(int(volume.resolution) / 4, coarsest, most);
    uint64_t cells = 0;
    for (int side = made.finest_; side >= coarsest; side /= 2, ++made.levels_)
        cells += uint64_t(side) * uint64_t(side) * uint64_t(side);

    return device.create_buffer({.name = "cones.emitter_cells", .size = cells * cell_bytes})
        .map(keep(made.cells_))
        .and_then([&] {
            return device
                .create_buffer({.name = "cones.emitters",
                                .size = sizeof(EmitterBlock),
                                .usage = rhi::BufferUsage::storage | rhi::BufferUsage::uniform})
                .map(keep(made.block_));
        })
        .and_then([&] {
            return device
                .create_sampler(
                    {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                .map(keep(made.sampler_));
        })
        .and_then([&] {
            return device
                .create_compute_pipeline<shaders::cones::emitter_cells>(
                    {.octree_levels = volume.octree_levels()})
                .map(keep(made.sum_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::cones::emitter_merge>().map(keep(made.merge_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::cones::emitter_choose>().map(keep(made.choose_));
        })
        .map([&] { return std::move(made); });
}

rhi::UniformBuffer Emitters::record(rhi::Commands& commands, const voxels::Volume& volume) {
    rhi::Pass pass = commands.pass("cones.emitters");
    const auto level0 = [&](const rhi::Texture& texture) {
        return rhi::Sampled<Dimension::d3>(texture.mip<Dimension::d3>(0), sampler_);
    };
    pass.dispatch(sum_,
                  {.emission = level0(volume.emission().base),
                   .albedo = level0(volume.albedo()),
                   .area = level0(volume.area()),
                   .normal = level0(volume.normal()),
                   .cells = cells_.slice(),
                   .octree_nodes = volume.view().nodes,
                   .records = volume.records()},
                  {.side = finest_, .size = int32_t(volume.settings().resolution) / finest_},
                  cell_groups(finest_));
    for (int level = 1; level < levels_; ++level)
        pass.dispatch(merge_, {.cells = cells_.slice()}, {.finest = finest_, .level = level},
                      cell_groups(finest_ >> level));
    pass.dispatch(
        choose_, {.cells = cells_.slice(), .emitters = block_.slice()},
        {.finest = finest_, .levels = levels_, .few = few, .emission_unit = volume.view().emission_unit}, {});
    return block_.slice();
}

}  // namespace lumo::cones
