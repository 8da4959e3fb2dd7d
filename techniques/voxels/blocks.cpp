#include "techniques/voxels/blocks.hpp"

#include <array>
#include <span>

#include "rhi/keep.hpp"

namespace lumo::voxels {

using rhi::Dimension;

void empty_volumes(rhi::Device& device, std::initializer_list<const rhi::Texture*> volumes) {
    rhi::Commands commands = device.begin();
    {
        rhi::Pass pass = commands.pass("voxels.empty");
        for (const rhi::Texture* volume : volumes) {
            if (!*volume) continue;
            if (volume->desc().format == rhi::Format::r32_uint) {
                pass.clear(volume->view(), std::array<uint32_t, 4>{});
            } else {
                pass.clear(volume->view());
            }
        }
    }
    device.submit(std::move(commands));
}

Result<Blocks> Blocks::create(rhi::Device& device, uint32_t resolution) {
    constexpr uint32_t block_side = 4;  // of shaders/voxels/block_list.glsl
    Blocks made;
    made.side_ = resolution / block_side;
    const uint64_t count = uint64_t(made.side_) * made.side_ * made.side_;
    return device.create_buffer({.name = "voxels.block_marks", .size = 4 * count})
        .map(keep(made.marks_))
        .and_then([&] {
            return device
                .create_buffer({.name = "voxels.blocks",
                                .size = 2 * arguments_stride + 4 * count,
                                .usage = rhi::BufferUsage::storage | rhi::BufferUsage::indirect})
                .map(keep(made.list_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::voxels::list_blocks>().map(
                keep(made.list_blocks_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::voxels::clear_blocks>().map(keep(made.clear_));
        })
        .map([&] {
            rhi::Commands commands = device.begin();
            {
                rhi::Pass pass = commands.pass("voxels.no_blocks");
                pass.fill(made.marks());
                pass.fill(made.list_slice());
            }
            device.submit(std::move(commands));
            return std::move(made);
        });
}

void Blocks::list(rhi::Pass& pass, bool keep) const {
    constexpr std::array<uint32_t, 8> none_yet{0, 1, 1, 0, 0, 1, 1, 0};
    pass.upload(list_.slice(0, sizeof none_yet), std::as_bytes(std::span(none_yet)));
    pass.dispatch(list_blocks_, {.marks = marks(), .blocks = list_slice()},
                  {.side = side_, .keep = keep ? 1u : 0u}, {rhi::groups_for(side_ * side_ * side_, 64)});
}

void Blocks::clear(rhi::Pass& pass, const rhi::Texture& volume, uint32_t words) const {
    pass.dispatch_indirect(clear_, {.volume = volume.mip<Dimension::d3>(0), .blocks = list_slice()},
                           {.words = int32_t(words)}, groups());
}

}  // namespace lumo::voxels
