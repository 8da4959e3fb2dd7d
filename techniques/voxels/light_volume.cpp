#include "techniques/voxels/light_volume.hpp"

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
    if (mips == MipKind::isotropic) return volume;

    const uint32_t half = resolution / 2;
    desc.name = name + ".directions";
    desc.extent = {6 * half, half, half};
    desc.mips = rhi::full_mips({half, half, half});
    Result<rhi::Texture> directions = device.create_texture(desc);
    if (!directions) return tl::unexpected(directions.error());
    volume.directions = std::move(*directions);
    return volume;
}

LightVolumeView view_of(const LightVolume& volume) {
    const rhi::Texture& directions = volume.directions ? volume.directions : volume.base;
    return {.base = volume.base.view<Dimension::d3>(), .directions = directions.view<Dimension::d3>()};
}

Result<Mips> Mips::create(rhi::Device& device, MipKind kind) {
    Mips mips;
    const auto keep = [](auto& place) { return [&place](auto made) { place = std::move(made); }; };
    Result<void> made = device
                            .create_sampler({.magnification = rhi::FilterMode::nearest,
                                             .minification = rhi::FilterMode::nearest})
                            .map(keep(mips.point_sampler_));
    if (made && kind == MipKind::isotropic) {
        made = device.create_compute_pipeline<shaders::voxels::mip>().map(keep(mips.isotropic_));
    }
    if (made && kind == MipKind::anisotropic) {
        made = device.create_compute_pipeline<shaders::voxels::mip_first_directional>().map(
            keep(mips.first_directional_));
    }
    if (made && kind == MipKind::anisotropic) {
        made = device.create_compute_pipeline<shaders::voxels::mip_directional>().map(
            keep(mips.next_directional_));
    }
    if (!made) return tl::unexpected(made.error());
    return mips;
}

void Mips::record(rhi::Pass& pass, const LightVolume& volume) const {
    const rhi::Texture& target = volume.directions ? volume.directions : volume.base;
    const auto finer = [&](const rhi::Texture& texture, uint32_t level) {
        return rhi::Sampled<Dimension::d3>(texture.mip<Dimension::d3>(level), point_sampler_);
    };
    const auto groups = [&](uint32_t level) {
        const rhi::Extent extent = rhi::mip_extent(target.desc().extent, level);
        return rhi::Groups{rhi::groups_for(extent.width, 4), rhi::groups_for(extent.height, 4),
                           rhi::groups_for(extent.depth, 4)};
    };
    if (volume.directions) {
        const uint32_t side = target.desc().extent.height;
        pass.clear(target.mip<Dimension::d3>(0));
        pass.dispatch(first_directional_,
                      {.finer = finer(volume.base, 0), .coarser = target.mip<Dimension::d3>(0)}, {},
                      {rhi::groups_for(side, 8), rhi::groups_for(side, 4), rhi::groups_for(side, 2)});
    }
    for (uint32_t level = 1; level < target.desc().mips; ++level) {
        if (volume.directions) {
            pass.dispatch(next_directional_,
                          {.finer = finer(target, level - 1), .coarser = target.mip<Dimension::d3>(level)},
                          {}, groups(level));
        } else {
            pass.dispatch(isotropic_,
                          {.finer = finer(target, level - 1), .coarser = target.mip<Dimension::d3>(level)},
                          {}, groups(level));
        }
    }
}

}  // namespace lumo::voxels
