#include "techniques/bounce/bounce.hpp"

#include "techniques/cones/gather.hpp"

namespace lumo::bounce {

using rhi::Dimension;

Result<Bounce> Bounce::create(rhi::Device& device, const Settings& settings, const Needs& needs,
                              const voxels::Volume& volume) {
    Bounce made;
    made.settings_ = settings;
    made.needs_ = needs;
    made.distribution_ = cones::distribution_of(settings.cones);
    const uint32_t count = gathers(settings, needs);
    for (uint32_t i = 0; i < std::min(count, 2u); ++i) {
        auto light = volume.create_light(device, i == 0 ? "bounce.radiance" : "bounce.radiance_next");
        if (!light) return tl::unexpected(light.error());
        made.radiance_[i] = std::move(*light);
    }
    auto sampler = device.create_sampler({.mip = rhi::FilterMode::linear});
    if (!sampler) return tl::unexpected(sampler.error());
    made.volume_sampler_ = std::move(*sampler);

    const auto create_gather = [&](bool reflected, auto& pipeline) {
        return device
            .create_compute_pipeline<shaders::bounce::bounce>(
                {.gather_reflected = reflected,
                 .gather_emission = needs.emission,
                 .gather_environment = needs.environment,
                 .anisotropic = volume.settings().mips == voxels::MipKind::anisotropic,
                 .octree_levels = volume.octree_levels(),
                 .whole_levels = settings.cones.turned,
                 .gather_sky = needs.sky,
                 .several_lights = needs.several_lights,
                 .by_rays = settings.rays > 0})
            .map([&](auto created) { pipeline = std::move(created); });
    };
    // Emission and environment are reflected for the first time by the first gather, which must not add what the
    // injection has reflected already; where there are analytic lights alone the first gather is the second reflection.
    Result<void> created;
    if (needs.any_light()) created = create_gather(false, made.first_);
    if (created && (!needs.any_light() || count > 1)) created = create_gather(true, made.next_);
    if (!created) return tl::unexpected(created.error());
    return made;
}

voxels::View Bounce::record(rhi::Commands& commands, const voxels::Volume& volume, cones::Source source) {
    const uint32_t count = gathers(settings_, needs_);
    const rhi::Extent cells = volume.cells();
    // block_log2 of shaders/bounce/bounce.comp.
    const rhi::Groups blocks = volume.octree()
                                   ? rhi::Groups{cells.width / 64, cells.height / 8, cells.depth}
                                   : rhi::Groups{cells.width / 8, cells.height / 8, cells.depth / 8};
    for (uint32_t i = 0; i < count; ++i) {
        const voxels::LightVolume& target = radiance_[i % 2];
        const cones::Gather gather = cones::make_gather(commands, distribution_, source, volume_sampler_);
        rhi::Pass pass = commands.pass("bounce");
        pass.dispatch(i == 0 && needs_.any_light() ? first_ : next_,
                      {.albedo = volume.albedo().mip<Dimension::d3>(0),
                       .area = volume.area().mip<Dimension::d3>(0),
                       .normal = volume.normal().mip<Dimension::d3>(0),
                       .direct_flux = volume.direct_flux().mip<Dimension::d3>(0),
                       .radiance = volume.light_cells(target),
                       .voxel_radiance = gather.radiance,
                       .voxel_radiance_directions = gather.radiance_directions,
                       .voxel_emission = gather.emission,
                       .voxel_emission_directions = gather.emission_directions,
                       .gather = gather.block,
                       .emitters = gather.emitters,
                       .block_marks = source.volume.block_marks,
                       .sky_map = gather.sky,
                       .voxels = volume.voxel_list(),
                       .voxel_nodes = gather.nodes},
                      {.flux = volume.injected().flux,
                       .lit_area = volume.injected().lit_area,
                       .lights = volume.injected().lights,
                       .radiance_scale = volume.injected().radiance_scale,
                       .rays = int32_t(std::min(settings_.rays, max_rays))},
                      blocks);
        volume.spread(pass, target);
        source.volume.radiance = voxels::view_of(target);
    }
    return source.volume;
}

}  // namespace lumo::bounce
