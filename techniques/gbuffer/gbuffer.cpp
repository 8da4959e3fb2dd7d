#include "techniques/gbuffer/gbuffer.hpp"

#include <string>

#include "rhi/keep.hpp"

namespace lumo::gbuffer {

using rhi::CullMode;
using rhi::Dimension;
using rhi::Format;

namespace {

CullMode cull_mode(const scene::DrawView& draw, const Needs& needs) {
    if (draw.double_sided && needs.double_sided) return CullMode::none;
    return draw.mirrored && needs.mirrored ? CullMode::front : CullMode::back;
}

}  // namespace

Needs needs_of(const scene::GeometryView& geometry, bool diffuse_materials) {
    Needs needs{.diffuse_materials = diffuse_materials};
    for (const scene::DrawView& draw : geometry.draws) {
        if (draw.alpha_mode == scene::AlphaMode::blend) continue;
        needs.emission |= draw.emits || draw.unlit;
        needs.alpha_mask |= draw.alpha_mode == scene::AlphaMode::mask;
        needs.normal_maps |= draw.normal_mapped && !diffuse_materials;
        needs.double_sided |= draw.double_sided;
        needs.mirrored |= draw.mirrored;
    }
    return needs;
}

template <class P>
Result<void> GBuffer::make_pipelines(rhi::Device& device, Pipelines<P>& pipelines) {
    rhi::RasterState state{.depth = rhi::DepthState{}};
    for (const rhi::Texture* target :
         {&base_color_metallic_, &normal_roughness_, &geometric_normal_occlusion_, &emission_})
        if (*target) state.color.push_back({.format = target->desc().format});
    const std::pair<CullMode, bool> culls[] = {
        {CullMode::back, true}, {CullMode::front, needs_.mirrored}, {CullMode::none, needs_.double_sided}};
    for (const bool alpha_test : {false, true}) {
        if (alpha_test && !needs_.alpha_mask) continue;
        for (const auto& [cull, needed] : culls) {
            if (!needed) continue;
            state.cull = cull;
            auto pipeline =
                device.create_raster_pipeline<P>(state, {.alpha_test = alpha_test,
                                                         .normal_mapping = needs_.normal_maps,
                                                         .diffuse_materials = needs_.diffuse_materials});
            if (!pipeline) return tl::unexpected(std::move(pipeline.error()));
            pipelines[alpha_test][size_t(cull)] = std::move(*pipeline);
        }
    }
    return {};
}

Result<GBuffer> GBuffer::create(rhi::Device& device, rhi::Extent size, const Needs& needs) {
    GBuffer made;
    made.needs_ = needs;
    const auto make = [&](rhi::Texture& target, const char* name, Format format) {
        return device
            .create_texture({.name = name,
                             .format = format,
                             .extent = size,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::attachment})
            .map(keep(target));
    };
    return make(made.base_color_metallic_, "gbuffer.base_color_metallic", Format::rgba8_srgb)
        .and_then(
            [&] { return make(made.normal_roughness_, "gbuffer.normal_roughness", Format::rgba16_float); })
        .and_then([&] {
            return make(made.geometric_normal_occlusion_, "gbuffer.geometric_normal_occlusion",
                        Format::rgba16_float);
        })
        .and_then([&] { return make(made.depth_, "gbuffer.depth", Format::d32_float); })
        .and_then([&]() -> Result<void> {
            if (!needs.emission) return made.make_pipelines(device, made.surface_);
            return make(made.emission_, "gbuffer.emission", Format::rgba16_float).and_then([&] {
                return made.make_pipelines(device, made.surface_emission_);
            });
        })
        .map([&] { return std::move(made); });
}

template <class P>
void GBuffer::draw_all(rhi::RasterPass& pass, const Pipelines<P>& pipelines,
                       const scene::GeometryView& geometry, rhi::UniformBuffer camera) const {
    for (const scene::DrawView& draw : geometry.draws) {
        if (draw.alpha_mode == scene::AlphaMode::blend) continue;
        const bool alpha_test = draw.alpha_mode == scene::AlphaMode::mask && needs_.alpha_mask;
        const scene::MaterialTextures& textures = geometry.textures[draw.material];
        typename P::Bindings bindings = [&] {
            if constexpr (std::is_same_v<P, shaders::gbuffer::surface_emission>)
                return typename P::Bindings{geometry.vertices,
                                            geometry.instances,
                                            geometry.material(draw.material),
                                            camera,
                                            textures.base_color,
                                            textures.metallic_roughness,
                                            textures.normal,
                                            textures.occlusion,
                                            textures.emission};
            else
                return typename P::Bindings{geometry.vertices,
                                            geometry.instances,
                                            geometry.material(draw.material),
                                            camera,
                                            textures.base_color,
                                            textures.metallic_roughness,
                                            textures.normal,
                                            textures.occlusion};
        }();
        pass.draw(pipelines[alpha_test][size_t(cull_mode(draw, needs_))], bindings,
                  {.first_instance = draw.first_instance},
                  rhi::DrawIndexed{.indices = geometry.indices,
                                   .count = draw.index_count,
                                   .instances = draw.instances,
                                   .first = draw.first_index});
    }
}

View GBuffer::record(rhi::Commands& commands, const scene::GeometryView& geometry,
                     const CameraBlock& camera) {
    View view{.size = depth_.desc().extent,
              .base_color_metallic = base_color_metallic_.view<Dimension::d2>(),
              .normal_roughness = normal_roughness_.view<Dimension::d2>(),
              .geometric_normal_occlusion = geometric_normal_occlusion_.view<Dimension::d2>(),
              .emission = {},
              .depth = depth_.view<Dimension::d2>(),
              .camera = commands.uniform(camera)};
    if (needs_.emission) view.emission = emission_.view<Dimension::d2>();

    rhi::RasterTargets targets{.color = {{.view = view.base_color_metallic},
                                         {.view = view.normal_roughness},
                                         {.view = view.geometric_normal_occlusion}},
                               .depth = rhi::DepthTarget{.view = view.depth}};
    if (view.emission) targets.color.push_back({.view = *view.emission});
    rhi::RasterPass pass = commands.raster_pass("gbuffer", targets);
    if (needs_.emission)
        draw_all(pass, surface_emission_, geometry, view.camera);
    else
        draw_all(pass, surface_, geometry, view.camera);
    return view;
}

}  // namespace lumo::gbuffer
