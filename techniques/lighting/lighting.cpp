#include "techniques/lighting/lighting.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "rhi/keep.hpp"

namespace lumo::lighting {

using rhi::CullMode;
using rhi::Dimension;
using rhi::Format;

Needs blend_needs_of(const scene::GeometryView& geometry) {
    Needs needs;
    for (const scene::DrawView& draw : geometry.draws) {
        if (draw.alpha_mode != scene::AlphaMode::blend) continue;
        needs.blend = true;
        needs.blend_double_sided |= draw.double_sided;
        needs.blend_mirrored |= draw.mirrored;
    }
    return needs;
}

template <class P>
Result<void> Lighting::make_blend_pipelines(rhi::Device& device, BlendPipelines<P>& pipelines,
                                            const typename P::Options& options) {
    using rhi::BlendFactor;
    const rhi::BlendState over{.source_color = BlendFactor::source_alpha,
                               .destination_color = BlendFactor::one_minus_source_alpha,
                               .source_alpha = BlendFactor::one,
                               .destination_alpha = BlendFactor::one_minus_source_alpha};
    rhi::RasterState state{.color = {{.format = Format::rgba32_float, .blend = over}},
                           .depth = rhi::DepthState{.write = false}};
    for (const CullMode cull : {CullMode::back, CullMode::front}) {
        if (cull == CullMode::front && !needs_.blend_double_sided && !needs_.blend_mirrored) continue;
        state.cull = cull;
        auto pipeline = device.create_raster_pipeline<P>(state, options);
        if (!pipeline) return tl::unexpected(std::move(pipeline.error()));
        pipelines[size_t(cull)] = std::move(*pipeline);
    }
    return {};
}

Result<Lighting> Lighting::create(rhi::Device& device, rhi::Extent size, const Needs& needs) {
    if (needs.blend && !rhi::has(device.format_caps(Format::rgba32_float), rhi::FormatCaps::blend))
        return fail(ErrorKind::unsupported, "blended surfaces", "this device cannot blend rgba32_float");
    Lighting made;
    made.needs_ = needs;
    const auto make_target = [&](rhi::Texture& target, const char* name, rhi::TextureUsage more) {
        return device
            .create_texture({.name = name,
                             .format = Format::rgba32_float,
                             .extent = size,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage | more})
            .map(keep(target));
    };
    const auto blend_usage = needs.blend ? rhi::TextureUsage::attachment : rhi::TextureUsage::none;
    auto done = make_target(made.radiance_, "lighting.radiance", blend_usage).and_then([&] {
        return device
            .create_sampler(
                {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
            .map(keep(made.sampler_));
    });
    if (!needs.lights) {
        done = done.and_then([&] {
            return device
                .create_texture({.name = "lighting.no_shadow_maps", .dimension = Dimension::d2_array})
                .map(keep(made.no_shadow_maps_));
        });
    }
    const auto make_shade = [&]<class P>(rhi::ComputePipeline<P>& pipeline) {
        return device
            .create_compute_pipeline<P>({.analytic_lights = needs.lights,
                                         .indirect_light = needs.indirect,
                                         .emission = needs.emission,
                                         .diffuse_materials = needs.diffuse_materials,
                                         .specular_light = needs.specular,
                                         .sky = needs.sky})
            .map(keep(pipeline));
    };
    if (needs.layers) {
        done = done.and_then([&] { return make_target(made.direct_, "lighting.direct", {}); })
                   .and_then([&] { return make_target(made.indirect_, "lighting.indirect", {}); })
                   .and_then([&] { return make_shade(made.shade_layers_); });
    } else {
        done = done.and_then([&] { return make_shade(made.shade_); });
    }
    if (needs.blend && needs.indirect) {
        done = done.and_then([&] {
            return made.make_blend_pipelines(device, made.blended_indirect_,
                                             {.analytic_lights = needs.lights,
                                              .diffuse_materials = needs.diffuse_materials,
                                              .air_before = needs.blend_air,
                                              .air_in_parts = needs.sky_in_parts,
                                              .gather_emission = needs.gather.emission,
                                              .gather_environment = needs.gather.environment,
                                              .anisotropic = needs.gather.anisotropic,
                                              .octree_levels = needs.gather.octree_levels,
                                              .gather_sky = needs.gather.sky});
        });
    } else if (needs.blend) {
        done = done.and_then([&] {
            return made.make_blend_pipelines(device, made.blended_,
                                             {.analytic_lights = needs.lights,
                                              .diffuse_materials = needs.diffuse_materials,
                                              .air_before = needs.blend_air,
                                              .air_in_parts = needs.sky_in_parts});
        });
    }
    if (needs.blend_air && needs.sky_in_parts) {
        done = done.and_then([&] { return make_target(made.share_, "lighting.share", blend_usage); })
                   .and_then([&] {
                       return device.create_compute_pipeline<shaders::lighting::add>().map(keep(made.add_));
                   });
    }
    return done.map([&] { return std::move(made); });
}

template <class P>
void Lighting::draw_blended(rhi::RasterPass& pass, const BlendPipelines<P>& pipelines, const Inputs& inputs,
                            const AnalyticLights& lights, const sky::Air& air) const {
    const scene::GeometryView& geometry = *inputs.geometry;
    std::vector<const scene::DrawView*> order;
    for (const scene::DrawView& draw : geometry.draws)
        if (draw.alpha_mode == scene::AlphaMode::blend) order.push_back(&draw);
    const auto distance = [&](const scene::DrawView* draw) {
        const glm::vec3 eye(inputs.eye);
        if (inputs.eye.w == 0) return -glm::dot(draw->center, eye);
        return glm::distance(draw->center, eye);
    };
    std::ranges::stable_sort(order, std::greater(), distance);

    for (const scene::DrawView* draw : order) {
        const scene::MaterialTextures& textures = geometry.textures[draw->material];
        const typename P::Bindings bindings = [&] {
            if constexpr (std::is_same_v<P, shaders::lighting::blended_indirect>)
                return typename P::Bindings{geometry.vertices,
                                            geometry.instances,
                                            geometry.material(draw->material),
                                            inputs.gbuffer.camera,
                                            textures.base_color,
                                            textures.metallic_roughness,
                                            textures.normal,
                                            textures.occlusion,
                                            textures.emission,
                                            lights.block,
                                            lights.shadow_maps,
                                            inputs.gather->radiance,
                                            inputs.gather->radiance_directions,
                                            inputs.gather->emission,
                                            inputs.gather->emission_directions,
                                            inputs.gather->block,
                                            inputs.gather->emitters,
                                            air.tables.block,
                                            air.tables.columns,
                                            air.tables.light,
                                            air.tables.peaks,
                                            air.view,
                                            inputs.gather->sky,
                                            inputs.gather->nodes};
            else
                return typename P::Bindings{geometry.vertices,
                                            geometry.instances,
                                            geometry.material(draw->material),
                                            inputs.gbuffer.camera,
                                            textures.base_color,
                                            textures.metallic_roughness,
                                            textures.normal,
                                            textures.occlusion,
                                            textures.emission,
                                            lights.block,
                                            lights.shadow_maps,
                                            air.tables.block,
                                            air.tables.columns,
                                            air.tables.light,
                                            air.tables.peaks,
                                            air.view};
        }();
        // Far faces of a body that is seen through come before its near ones.
        const CullMode near_faces = draw->mirrored ? CullMode::front : CullMode::back;
        const CullMode far_faces = draw->mirrored ? CullMode::back : CullMode::front;
        for (const CullMode cull : {far_faces, near_faces}) {
            if (cull == far_faces && !draw->double_sided) continue;
            pass.draw(pipelines[size_t(cull)], bindings, {.first_instance = draw->first_instance},
                      rhi::DrawIndexed{.indices = geometry.indices,
                                       .count = draw->index_count,
                                       .instances = draw->instances,
                                       .first = draw->first_index});
        }
    }
}

/// Over what is there, what a surface sends at all wavelengths. Where these are in several parts, each part is drawn by
/// itself, over nothing but for the first, and the sum is the same: what lies behind is weakened in all of them alike.
void Lighting::blend(rhi::Commands& commands, const Inputs& inputs, const AnalyticLights& lights) {
    const gbuffer::View& g = inputs.gbuffer;
    std::vector<sky::Air> parts;
    if (needs_.blend_air) {
        parts = inputs.sky->before;
    } else {
        const rhi::Sampled<Dimension::d2> unread(g.base_color_metallic, sampler_);
        parts.push_back({.tables = {.block = commands.uniform(shaders::lighting::blended::Atmosphere{}),
                                    .columns = unread,
                                    .light = lights.shadow_maps,
                                    .peaks = unread},
                         .view = commands.uniform(shaders::lighting::blended::Sky{})});
    }
    for (size_t i = 0; i < parts.size(); ++i) {
        const rhi::Texture& target = i == 0 ? radiance_ : share_;
        {
            rhi::RasterPass pass = commands.raster_pass(
                "lighting.blend", {.color = {{.view = target.view<Dimension::d2>(),
                                              .load = i == 0 ? rhi::Load::keep : rhi::Load::clear}},
                                   .depth = rhi::DepthTarget{.view = g.depth, .load = rhi::Load::keep}});
            if (needs_.indirect)
                draw_blended(pass, blended_indirect_, inputs, lights, parts[i]);
            else
                draw_blended(pass, blended_, inputs, lights, parts[i]);
        }
        if (i == 0) continue;
        commands.pass("lighting.add")
            .dispatch(add_,
                      {.share = {target.view<Dimension::d2>(), sampler_},
                       .radiance = radiance_.view<Dimension::d2>()},
                      {}, rhi::groups_for(g.size, {8, 8}));
    }
}

View Lighting::record(rhi::Commands& commands, const Inputs& inputs) {
    const gbuffer::View& g = inputs.gbuffer;
    View view{.radiance = radiance_.view<Dimension::d2>(), .direct = {}, .indirect = {}};
    // Options leave unread what is not there; some view has to stand for it.
    const AnalyticLights lights{
        .block = inputs.lights ? inputs.lights->block : commands.uniform(shadow::Block{}),
        .shadow_maps = {inputs.lights ? inputs.lights->depth : no_shadow_maps_.view<Dimension::d2_array>(),
                        sampler_}};
    const auto sampled = [&](rhi::View<Dimension::d2> v) { return rhi::Sampled<Dimension::d2>(v, sampler_); };
    const rhi::Groups groups = rhi::groups_for(g.size, {8, 8});
    {
        rhi::Pass pass = commands.pass("lighting.shade");
        const auto emission = sampled(g.emission.value_or(g.base_color_metallic));
        const auto irradiance = sampled(inputs.irradiance.value_or(g.base_color_metallic));
        const auto specular = sampled(inputs.specular.value_or(g.base_color_metallic));
        const auto sky_radiance = sampled(inputs.sky ? inputs.sky->radiance : g.base_color_metallic);
        const auto sky_transmittance =
            sampled(inputs.sky ? inputs.sky->transmittance : g.base_color_metallic);
        if (needs_.layers) {
            view.direct = direct_.view<Dimension::d2>();
            view.indirect = indirect_.view<Dimension::d2>();
            pass.dispatch(shade_layers_,
                          {sampled(g.depth), sampled(g.base_color_metallic), sampled(g.normal_roughness),
                           sampled(g.geometric_normal_occlusion), emission, irradiance, lights.shadow_maps,
                           g.camera, lights.block, view.radiance, *view.direct, *view.indirect, specular,
                           sky_radiance, sky_transmittance},
                          {.environment = inputs.environment}, groups);
        } else {
            pass.dispatch(shade_,
                          {sampled(g.depth), sampled(g.base_color_metallic), sampled(g.normal_roughness),
                           sampled(g.geometric_normal_occlusion), emission, irradiance, lights.shadow_maps,
                           g.camera, lights.block, view.radiance, specular, sky_radiance, sky_transmittance},
                          {.environment = inputs.environment}, groups);
        }
    }
    if (needs_.blend) blend(commands, inputs, lights);
    return view;
}

}  // namespace lumo::lighting
