#include "techniques/cones/dense_gather.hpp"

#include <algorithm>

namespace lumo::cones {
namespace {

using rhi::Dimension;

constexpr uint32_t group_side = 8;                 // pixels
constexpr uint64_t most_rays = uint64_t(1) << 21;  // a dispatch
// Software drivers cut an invocation off after as many turns of its loops, 65 535, whatever the loops.
constexpr uint32_t most_steps = 60'000;

}  // namespace

Result<DenseGather> DenseGather::create(rhi::Device& device, uint32_t rays, const Needs& needs,
                                        rhi::Extent size) {
    DenseGather made;
    made.rays_ = std::clamp(rays, 1u, max_rays);
    made.size_ = size;
    return device
        .create_texture({.name = "cones.rays",
                         .format = rhi::Format::rgba32_float,
                         .extent = size,
                         .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
        .and_then([&](rhi::Texture texture) {
            made.irradiance_ = std::move(texture);
            return device.create_sampler(
                {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest});
        })
        .and_then([&](rhi::Sampler sampler) {
            made.point_sampler_ = std::move(sampler);
            return device.create_compute_pipeline<shaders::cones::dense_gather>(
                {.gather_emission = needs.emission,
                 .gather_environment = needs.environment,
                 .gather_sky = needs.sky,
                 .octree_levels = needs.octree_levels});
        })
        .map([&](rhi::ComputePipeline<shaders::cones::dense_gather> pipeline) {
            made.pipeline_ = std::move(pipeline);
            return std::move(made);
        });
}

rhi::View<Dimension::d2> DenseGather::record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                             const Source& source) {
    const voxels::View& volume = source.volume;
    const uint32_t batch = std::min(rays_, std::max(most_steps / (3 * volume.grid.resolution), 1u));
    const uint64_t row_rays = uint64_t(size_.width) * batch;
    const uint32_t rows = uint32_t(std::max<uint64_t>(most_rays / row_rays / group_side, 1)) * group_side;
    rhi::Pass pass = commands.pass("cones.rays");
    for (uint32_t ray = 0; ray < rays_; ray += batch)
        for (uint32_t row = 0; row < size_.height; row += rows) {
            pass.dispatch(pipeline_,
                          {.depth = {gbuffer.depth, point_sampler_},
                           .normal_roughness = {gbuffer.normal_roughness, point_sampler_},
                           .geometric_normal_occlusion = {gbuffer.geometric_normal_occlusion, point_sampler_},
                           .camera = gbuffer.camera,
                           .radiance = {volume.radiance.base, point_sampler_},
                           .emission = {volume.emission.base, point_sampler_},
                           .nodes = volume.nodes,
                           .irradiance = irradiance_.view<Dimension::d2>(),
                           .sky_map = source.sky.value_or(
                               rhi::Sampled<Dimension::d3>(volume.radiance.base, point_sampler_))},
                          {.grid_origin = volume.grid.origin,
                           .voxels_per_metre = 1 / volume.grid.voxel_size,
                           .environment = source.environment,
                           .radiance_unit = volume.radiance_unit,
                           .emission_unit = volume.emission_unit,
                           .resolution = int32_t(volume.grid.resolution),
                           .rays = int32_t(rays_),
                           .first_ray = int32_t(ray),
                           .end_ray = int32_t(std::min(ray + batch, rays_)),
                           .first_row = int32_t(row)},
                          {rhi::groups_for(size_.width, group_side),
                           rhi::groups_for(std::min(rows, size_.height - row), group_side)});
        }
    return irradiance_.view<Dimension::d2>();
}

}  // namespace lumo::cones
