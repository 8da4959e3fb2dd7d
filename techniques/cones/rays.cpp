#include "techniques/cones/rays.hpp"

#include <algorithm>

#include "rhi/keep.hpp"

namespace lumo::cones {
namespace {

using rhi::Dimension;

constexpr uint32_t group_side = 8;                 // pixels
constexpr uint64_t most_rays = uint64_t(1) << 21;  // a dispatch
// Software drivers cut an invocation off after as many turns of its loops, 65 535, whatever the loops.
constexpr uint32_t most_steps = 60'000;

}  // namespace

Result<Rays> Rays::create(rhi::Device& device, const RaySettings& settings, const Needs& needs,
                          rhi::Extent size) {
    Rays made;
    made.rays_ = std::clamp(settings.count, 1u, max_rays);
    made.size_ = size;
    Result<void> done =
        device
            .create_texture({.name = "cones.rays",
                             .format = rhi::Format::rgba32_float,
                             .extent = size,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
            .map(keep(made.irradiance_))
            .and_then([&] {
                return device.create_sampler({.mip = rhi::FilterMode::linear})
                    .map(keep(made.volume_sampler_));
            })
            .and_then([&] {
                return device
                    .create_sampler(
                        {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                    .map(keep(made.point_sampler_));
            })
            .and_then([&] {
                return device
                    .create_compute_pipeline<shaders::cones::rays>({.gather_emission = needs.emission,
                                                                    .gather_environment = needs.environment,
                                                                    .anisotropic = needs.anisotropic,
                                                                    .octree_levels = needs.octree_levels,
                                                                    .gather_sky = needs.sky})
                    .map(keep(made.pipeline_));
            });
    if (settings.smoothed)
        done = done.and_then([&] { return PatternMean::create(device, "cones.rays.gathered", size); })
                   .map(keep(made.mean_));
    return done.map([&] { return std::move(made); });
}

rhi::View<Dimension::d2> Rays::record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                      const Source& source) {
    const voxels::View& volume = source.volume;
    const Gather gather = make_gather(commands, {}, source, volume_sampler_);
    const uint32_t batch = std::min(rays_, std::max(most_steps / (3 * volume.grid.resolution), 1u));
    const uint64_t row_rays = uint64_t(size_.width) * batch;
    const uint32_t rows = uint32_t(std::max<uint64_t>(most_rays / row_rays / group_side, 1)) * group_side;
    const rhi::View<Dimension::d2> irradiance = irradiance_.view<Dimension::d2>();
    rhi::Pass pass = commands.pass("cones.rays");
    for (uint32_t ray = 0; ray < rays_; ray += batch)
        for (uint32_t row = 0; row < size_.height; row += rows) {
            pass.dispatch(pipeline_,
                          {.depth = {gbuffer.depth, point_sampler_},
                           .normal_roughness = {gbuffer.normal_roughness, point_sampler_},
                           .geometric_normal_occlusion = {gbuffer.geometric_normal_occlusion, point_sampler_},
                           .camera = gbuffer.camera,
                           .voxel_radiance = gather.radiance,
                           .voxel_radiance_directions = gather.radiance_directions,
                           .voxel_emission = gather.emission,
                           .voxel_emission_directions = gather.emission_directions,
                           .gather = gather.block,
                           .emitters = gather.emitters,
                           .irradiance = mean_ ? mean_->gathered() : irradiance,
                           .block_marks = volume.block_marks,
                           .sky_map = gather.sky,
                           .voxel_nodes = gather.nodes},
                          {.rays = int32_t(rays_),
                           .first_ray = int32_t(ray),
                           .end_ray = int32_t(std::min(ray + batch, rays_)),
                           .first_row = int32_t(row)},
                          {rhi::groups_for(size_.width, group_side),
                           rhi::groups_for(std::min(rows, size_.height - row), group_side)});
        }
    if (mean_) mean_->record(pass, gbuffer, volume.grid.voxel_size, irradiance);
    return irradiance;
}

}  // namespace lumo::cones
