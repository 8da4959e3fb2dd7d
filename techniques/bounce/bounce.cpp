#include "techniques/bounce/bounce.hpp"

#include "techniques/cones/gather.hpp"

namespace lumo::bounce {

using rhi::Dimension;

Result<Bounce> Bounce::create(rhi::Device& device, const Settings& settings, const Needs& needs,
                              const voxels::Settings& volume) {
    Bounce made;
    made.settings_ = settings;
    made.needs_ = needs;
    made.distribution_ = cones::distribute(settings.cones);
    const uint32_t count = gathers(settings, needs);
    for (uint32_t i = 0; i < std::min(count, 2u); ++i) {
        auto texture = device.create_texture(voxels::radiance_desc(
            i == 0 ? "bounce.radiance" : "bounce.radiance_next", volume.resolution, needs.wide_range));
        if (!texture) return tl::unexpected(texture.error());
        made.radiance_[i] = std::move(*texture);
    }
    auto sampler = device.create_sampler({.mip = rhi::FilterMode::linear});
    if (!sampler) return tl::unexpected(sampler.error());
    made.volume_sampler_ = std::move(*sampler);

    // Emission and environment are reflected for the first time by the first gather, which must not add what
    // the sun has already done once; where the sun is alone the first gather is its second reflection.
    if (needs.any_light()) {
        auto first = device.create_compute_pipeline<shaders::bounce::bounce>(
            {.gather_reflected = false,
             .gather_emission = needs.emission,
             .gather_environment = needs.environment});
        if (!first) return tl::unexpected(first.error());
        made.first_ = std::move(*first);
    }
    if (!needs.any_light() || count > 1) {
        auto next = device.create_compute_pipeline<shaders::bounce::bounce>(
            {.gather_reflected = true,
             .gather_emission = needs.emission,
             .gather_environment = needs.environment});
        if (!next) return tl::unexpected(next.error());
        made.next_ = std::move(*next);
    }
    return made;
}

voxels::View Bounce::record(rhi::Commands& commands, const voxels::Volume& volume, glm::vec3 environment) {
    voxels::View light = volume.view();
    const uint32_t count = gathers(settings_, needs_);
    for (uint32_t i = 0; i < count; ++i) {
        const rhi::Texture& target = radiance_[i % 2];
        const rhi::UniformBuffer gather =
            commands.uniform(cones::gather_block(distribution_, light, environment));
        rhi::Pass pass = commands.pass("bounce");
        pass.dispatch(i == 0 && needs_.any_light() ? first_ : next_,
                      {.albedo = volume.albedo().mip<Dimension::d3>(0),
                       .area = volume.area().mip<Dimension::d3>(0),
                       .normal = volume.normal().mip<Dimension::d3>(0),
                       .lit_texels = volume.lit_texels().mip<Dimension::d3>(0),
                       .radiance = target.mip<Dimension::d3>(0),
                       .voxel_radiance = {light.radiance, volume_sampler_},
                       .voxel_emission = {light.emission, volume_sampler_},
                       .gather = gather},
                      {.irradiance = volume.injected().irradiance,
                       .texel_voxel_faces = volume.injected().texel_voxel_faces,
                       .radiance_scale = volume.injected().radiance_scale},
                      voxels::voxel_groups(volume.settings().resolution));
        volume.mips().record(pass, target);
        light.radiance = target.view<Dimension::d3>();
    }
    return light;
}

}  // namespace lumo::bounce
