#include "techniques/cones/cones.hpp"

#include "rhi/keep.hpp"
#include "techniques/cones/gather.hpp"

namespace lumo::cones {

using rhi::Dimension;

Result<Irradiance> Irradiance::create(rhi::Device& device, const Settings& settings, const Needs& needs,
                                      rhi::Extent size) {
    Irradiance made;
    made.distribution_ = distribution_of(settings);
    made.size_ = size;
    made.name_ = needs.occlusion ? "cones.ao" : "cones.irradiance";
    Result<void> done =
        device
            .create_texture({.name = std::string(made.name_),
                             .format = rhi::Format::rgba32_float,
                             .extent = size,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
            .map(keep(made.irradiance_))
            .and_then([&] {
                return device.create_sampler(volume_sampling(settings)).map(keep(made.volume_sampler_));
            })
            .and_then([&] {
                return device
                    .create_sampler(
                        {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                    .map(keep(made.point_sampler_));
            })
            .and_then([&] {
                return device
                    .create_compute_pipeline<shaders::cones::irradiance>(
                        {.gather_emission = needs.emission,
                         .gather_environment = needs.environment,
                         .anisotropic = needs.anisotropic,
                         .octree_levels = needs.octree_levels,
                         .whole_levels = settings.turned,
                         .gather_occlusion = needs.occlusion,
                         .gather_sky = needs.sky})
                    .map(keep(made.pipeline_));
            });
    if (settings.turned)
        done = done.and_then([&] {
                       return PatternMean::create(device, std::string(made.name_) + ".gathered", size);
                   })
                   .map(keep(made.mean_));
    return done.map([&] { return std::move(made); });
}

rhi::View<Dimension::d2> Irradiance::record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                            const Source& source) {
    const Gather gather = make_gather(commands, distribution_, source, volume_sampler_);
    const rhi::View<Dimension::d2> irradiance = irradiance_.view<Dimension::d2>();
    rhi::Pass pass = commands.pass(name_);
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
                   .sky_map = gather.sky,
                   .voxel_nodes = gather.nodes},
                  {}, rhi::groups_for(size_, {8, 8}));
    if (mean_) mean_->record(pass, gbuffer, source.volume.grid.voxel_size, irradiance);
    return irradiance;
}

}  // namespace lumo::cones
