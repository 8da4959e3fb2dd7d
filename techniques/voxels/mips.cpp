#include "techniques/voxels/mips.hpp"

namespace lumo::voxels {

using rhi::Dimension;

Result<Mips> Mips::create(rhi::Device& device) {
    Mips mips;
    return device
        .create_sampler({.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
        .and_then([&](rhi::Sampler sampler) {
            mips.point_sampler_ = std::move(sampler);
            return device.create_compute_pipeline<shaders::voxels::mip>();
        })
        .map([&](rhi::ComputePipeline<shaders::voxels::mip> pipeline) {
            mips.pipeline_ = std::move(pipeline);
            return std::move(mips);
        });
}

void Mips::record(rhi::Pass& pass, const rhi::Texture& volume) const {
    const rhi::TextureDesc& desc = volume.desc();
    for (uint32_t level = 1; level < desc.mips; ++level) {
        const uint32_t groups = rhi::groups_for(rhi::mip_extent(desc.extent, level).width, 4);
        pass.dispatch(pipeline_,
                      {.finer = {volume.mip<Dimension::d3>(level - 1), point_sampler_},
                       .coarser = volume.mip<Dimension::d3>(level)},
                      {}, {groups, groups, groups});
    }
}

}  // namespace lumo::voxels
