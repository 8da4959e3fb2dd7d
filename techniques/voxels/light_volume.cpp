#include "techniques/voxels/light_volume.hpp"

#include "rhi/keep.hpp"

namespace lumo::voxels {

using rhi::Dimension;

Result<LightVolume> LightVolume::create(rhi::Device& device, const std::string& name, uint32_t resolution,
                                        MipKind mips, bool wide_range) {
    const rhi::Extent extent{resolution, resolution, resolution};
    rhi::TextureDesc desc{.name = name,
                          .dimension = Dimension::d3,
                          .format = wide_range ? rhi::Format::rgba16_float : rhi::Format::rgba8_unorm,
                          .extent = extent,
                          .mips = mips == MipKind::isotropic ? rhi::full_mips(extent) : 1,
                          .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage};
    LightVolume volume;
    Result<rhi::Texture> base = device.create_texture(desc);
    if (!base) return tl::unexpected(base.error());
    volume.base = std::move(*base);
    empty_volumes(device, {&volume.base});
    if (mips == MipKind::isotropic) return volume;

    const uint32_t half = resolution / 2;
    desc.name = name + ".directions";
    desc.extent = {6 * half, half, half};
    desc.mips = rhi::full_mips({half, half, half});
    Result<rhi::Texture> directions = device.create_texture(desc);
    if (!directions) return tl::unexpected(directions.error());
    volume.directions = std::move(*directions);
    empty_volumes(device, {&volume.directions});
    return volume;
}

LightVolumeView view_of(const LightVolume& volume) {
    const rhi::Texture& directions = volume.directions ? volume.directions : volume.base;
    return {.base = volume.base.view<Dimension::d3>(), .directions = directions.view<Dimension::d3>()};
}

Result<Mips> Mips::create(rhi::Device& device, MipKind kind) {
    Mips mips;
    Result<void> made = device
                            .create_sampler({.magnification = rhi::FilterMode::nearest,
                                             .minification = rhi::FilterMode::nearest})
                            .map(keep(mips.point_sampler_));
    // What is bound where no block is listed.
    if (made) made = device.create_buffer({.name = "voxels.all_blocks", .size = 36}).map(keep(mips.no_list_));
    for (const bool listed : {false, true}) {
        if (made && kind == MipKind::isotropic) {
            made = device.create_compute_pipeline<shaders::voxels::mip>({.listed = listed})
                       .map(keep(mips.isotropic_[listed]));
        }
        if (made && kind == MipKind::anisotropic) {
            made = device.create_compute_pipeline<shaders::voxels::mip_first_directional>({.listed = listed})
                       .map(keep(mips.first_directional_[listed]));
        }
        if (made && kind == MipKind::anisotropic) {
            made = device.create_compute_pipeline<shaders::voxels::mip_directional>({.listed = listed})
                       .map(keep(mips.next_directional_[listed]));
        }
    }
    if (!made) return tl::unexpected(made.error());
    return mips;
}

void Mips::record(rhi::Pass& pass, const LightVolume& volume, const Blocks* blocks) const {
    const rhi::Texture& target = volume.directions ? volume.directions : volume.base;
    const rhi::BufferSlice list = blocks ? blocks->list_slice() : no_list_.slice();
    const auto make = [&]<class P>(const rhi::ComputePipeline<P>(&pipelines)[2], const rhi::Texture& from,
                                   uint32_t from_mip, uint32_t mip, bool listed) {
        const typename P::Bindings bindings{.finer = {from.mip<Dimension::d3>(from_mip), point_sampler_},
                                            .coarser = target.mip<Dimension::d3>(mip),
                                            .blocks = list};
        const rhi::Extent extent = rhi::mip_extent(target.desc().extent, mip);
        if (blocks && listed) {
            pass.dispatch_indirect(pipelines[1], bindings, {}, blocks->groups_of_eight());
        } else {
            pass.dispatch(pipelines[0], bindings, {}, rhi::groups_for(extent, {4, 4, 4}));
        }
    };
    // Level 1 of both kinds and level 2 of six directions in the blocks alone; of what is coarser, all is little.
    if (volume.directions) make(first_directional_, volume.base, 0, 0, true);
    for (uint32_t mip = 1; mip < target.desc().mips; ++mip) {
        if (volume.directions) {
            make(next_directional_, target, mip - 1, mip, mip == 1);
        } else {
            make(isotropic_, target, mip - 1, mip, mip == 1);
        }
    }
}

}  // namespace lumo::voxels
