#include "techniques/bounce/bounce.hpp"

#include "rhi/keep.hpp"
#include "techniques/cones/gather.hpp"

namespace lumo::bounce {

using rhi::Dimension;

Result<Bounce> Bounce::create(rhi::Device& device, const Settings& settings, const Needs& needs,
                              const voxels::Volume& volume) {
    Bounce made;
    made.settings_ = settings;
    made.needs_ = needs;
    if (settings.rays == 0) made.distribution_ = cones::distribution_of(settings.cones);
    const uint32_t count = gathers(settings, needs);
    for (uint32_t i = 0; i < std::min(count, 2u); ++i) {
        auto light = volume.create_light(device, i == 0 ? "bounce.radiance" : "bounce.radiance_next");
        if (!light) return tl::unexpected(light.error());
        made.radiance_[i] = std::move(*light);
    }
    auto sampler = device.create_sampler(cones::volume_sampling(settings.cones));
    if (!sampler) return tl::unexpected(sampler.error());
    made.volume_sampler_ = std::move(*sampler);

    const Result<void> created = settings.rays > 0 ? made.create_pipelines(device, volume, made.by_rays_)
                                                   : made.create_pipelines(device, volume, made.by_cones_);
    if (!created) return tl::unexpected(created.error());
    return made;
}

template <rhi::Program P>
Result<void> Bounce::create_pipelines(rhi::Device& device, const voxels::Volume& volume,
                                      Pipelines<P>& pipelines) {
    const auto create_gather = [&](bool reflected, rhi::ComputePipeline<P>& pipeline) {
        return device
            .create_compute_pipeline<P>(
                {.gather_reflected = reflected,
                 .gather_emission = needs_.emission,
                 .gather_environment = needs_.environment,
                 .anisotropic = volume.settings().mips == voxels::MipKind::anisotropic,
                 .octree_levels = volume.octree_levels(),
                 .whole_levels = distribution_.sets > 1,
                 .gather_sky = needs_.sky,
                 .several_lights = needs_.several_lights})
            .map(keep(pipeline));
    };
    // Emission and environment are reflected for the first time by the first gather, which must not add what the
    // injection has reflected already; where there are analytic lights alone the first gather is the second reflection.
    Result<void> created;
    if (needs_.any_light()) created = create_gather(false, pipelines.first);
    if (created && (!needs_.any_light() || gathers(settings_, needs_) > 1))
        created = create_gather(true, pipelines.next);
    return created;
}

template <rhi::Program P>
void Bounce::gather(rhi::Pass& pass, const voxels::Volume& volume, const Pipelines<P>& pipelines, bool first,
                    const cones::Gather& source, const voxels::LightVolume& target) const {
    const rhi::Extent cells = volume.cells();
    // block_log2 of shaders/bounce/bounce.glsl.
    const rhi::Groups blocks = volume.octree()
                                   ? rhi::Groups{cells.width / 64, cells.height / 8, cells.depth}
                                   : rhi::Groups{cells.width / 8, cells.height / 8, cells.depth / 8};
    pass.dispatch(first ? pipelines.first : pipelines.next,
                  {.albedo = volume.albedo().mip<Dimension::d3>(0),
                   .area = volume.area().mip<Dimension::d3>(0),
                   .normal = volume.normal().mip<Dimension::d3>(0),
                   .direct_flux = volume.direct_flux().mip<Dimension::d3>(0),
                   .radiance = volume.light_cells(target),
                   .voxel_radiance = source.radiance,
                   .voxel_radiance_directions = source.radiance_directions,
                   .voxel_emission = source.emission,
                   .voxel_emission_directions = source.emission_directions,
                   .gather = source.block,
                   .emitters = source.emitters,
                   .block_marks = volume.view().block_marks,
                   .sky_map = source.sky,
                   .voxels = volume.voxel_list(),
                   .voxel_nodes = source.nodes},
                  {.flux = volume.injected().flux,
                   .lit_area = volume.injected().lit_area,
                   .lights = volume.injected().lights,
                   .radiance_scale = volume.injected().radiance_scale,
                   .rays = int32_t(std::min(settings_.rays, max_rays))},
                  blocks);
}

voxels::View Bounce::record(rhi::Commands& commands, const voxels::Volume& volume, cones::Source source) {
    const uint32_t count = gathers(settings_, needs_);
    for (uint32_t i = 0; i < count; ++i) {
        const voxels::LightVolume& target = radiance_[i % 2];
        const cones::Gather from = cones::make_gather(commands, distribution_, source, volume_sampler_);
        const bool first = i == 0 && needs_.any_light();
        rhi::Pass pass = commands.pass("bounce");
        if (settings_.rays > 0)
            gather(pass, volume, by_rays_, first, from, target);
        else
            gather(pass, volume, by_cones_, first, from, target);
        volume.spread(pass, target);
        source.volume.radiance = voxels::view_of(target);
    }
    return source.volume;
}

}  // namespace lumo::bounce
