// Radiance in a cubic volume with its mips, isotropic or in six directions.
#pragma once

#include <cstdint>
#include <string>

#include "rhi/rhi.hpp"
#include "shaders/voxels/mip.hpp"
#include "shaders/voxels/mip_directional.hpp"
#include "shaders/voxels/mip_first_directional.hpp"
#include "techniques/voxels/blocks.hpp"

namespace lumo::voxels {

/// How voxels are averaged into coarser ones. `isotropic`: the mean of eight; it mixes the colours of a wall's two
/// sides, and a thin wall turns transparent with distance. `anisotropic`: one value per direction of travel along
/// the axes, nearer voxels over farther ones, from mip 1 on; 1.625 times the memory.
enum class MipKind : uint8_t { isotropic, anisotropic };

/// Values are radiance times opacity; a: opacity.
struct LightVolume {
    rhi::Texture base;  ///< level 0; isotropic: all mips
    /// Anisotropic: mips from 1 on, as shaders/voxels/mip_directional.comp lays them out.
    rhi::Texture directions;

    /// rgba8_unorm, or rgba16_float where 8 bits do not do; all 0. Errors: those of the device.
    static Result<LightVolume> create(rhi::Device& device, const std::string& name, uint32_t resolution,
                                      MipKind mips, bool wide_range);
};

/// What cones read of a volume.
struct LightVolumeView {
    rhi::View<rhi::Dimension::d3> base;
    rhi::View<rhi::Dimension::d3> directions;  ///< the base again where mips are isotropic
};
LightVolumeView view_of(const LightVolume& volume);

/// Makes the mips of volumes of one kind.
class Mips {
  public:
    static Result<Mips> create(rhi::Device& device, MipKind kind);

    /// All mips from level 0, of which nothing but the listed blocks has changed; without a list, all of it.
    void record(rhi::Pass& pass, const LightVolume& volume, const Blocks* blocks = nullptr) const;

  private:
    rhi::Sampler point_sampler_;
    rhi::Buffer no_list_;
    /// Of all of a volume, and of listed blocks.
    rhi::ComputePipeline<shaders::voxels::mip> isotropic_[2];
    rhi::ComputePipeline<shaders::voxels::mip_first_directional> first_directional_[2];
    rhi::ComputePipeline<shaders::voxels::mip_directional> next_directional_[2];
};

}  // namespace lumo::voxels
