#include "techniques/cones/gather.hpp"

#include <cmath>

namespace lumo::cones {
namespace {

GatherBlock gather_block(const Distribution& distribution, const Source& source) {
    const voxels::View& volume = source.volume;
    GatherBlock block{};
    block.grid_origin = volume.grid.origin;
    block.voxels_per_metre = 1 / volume.grid.voxel_size;
    block.radiance_unit = volume.radiance_unit;
    block.emission_unit = volume.emission_unit;
    block.cone_count = int32_t(distribution.cones.size()) / distribution.sets;
    block.environment = source.environment;
    block.resolution = float(volume.grid.resolution);
    block.occlusion_radius =
        source.occlusion_radius ? *source.occlusion_radius / volume.grid.voxel_size : 0.1f * block.resolution;
    for (size_t i = 0; i < distribution.cones.size(); ++i) {
        const Cone& cone = distribution.cones[i];
        block.cones[i] =
            glm::vec4(cone.direction.x, cone.direction.y, std::tan(cone.half_angle), cone.weight);
    }
    return block;
}

}  // namespace

rhi::SamplerDesc volume_sampling(const Settings& settings) {
    return {.mip = settings.turned ? rhi::FilterMode::nearest : rhi::FilterMode::linear};
}

Gather make_gather(rhi::Commands& commands, const Distribution& distribution, const Source& source,
                   rhi::SamplerHandle volume_sampler) {
    const voxels::View& volume = source.volume;
    return {
        .radiance = {volume.radiance.base, volume_sampler},
        .radiance_directions = {volume.radiance.directions, volume_sampler},
        .emission = {volume.emission.base, volume_sampler},
        .emission_directions = {volume.emission.directions, volume_sampler},
        .block = commands.uniform(gather_block(distribution, source)),
        .emitters = source.emitters ? *source.emitters : commands.uniform(EmitterBlock{}),
        .sky = source.sky.value_or(rhi::Sampled<rhi::Dimension::d3>(volume.radiance.base, volume_sampler)),
        .nodes = volume.nodes};
}

}  // namespace lumo::cones
