#include "techniques/frame/layers.hpp"

#include <string>

#include "rhi/keep.hpp"

namespace lumo::frame {
namespace {

using rhi::Dimension;

rhi::Groups pixel_groups(rhi::Extent size) { return rhi::groups_for(size, {8, 8}); }

/// dot(plane, (world, 1)) is the distance along the optical axis.
glm::vec4 axis_plane(const scene::Camera& camera) {
    const glm::vec3 axis = glm::normalize(camera.target - camera.position);
    return {axis, -glm::dot(axis, camera.position)};
}

}  // namespace

Result<Layers> Layers::create(rhi::Device& device, const Settings& settings) {
    Layers layers;
    layers.size_ = settings.size;
    for (const Layer layer : settings.layers) {
        if (layer == Layer::final) continue;
        auto texture = device.create_texture({.name = "layer." + std::string(to_string(layer)),
                                              .format = rhi::Format::rgba32_float,
                                              .extent = settings.size,
                                              .usage = rhi::TextureUsage::storage});
        if (!texture) return tl::unexpected(texture.error());
        layers.textures_.emplace(layer, std::move(*texture));
    }
    if (layers.textures_.empty()) return layers;

    Result<void> made = device
                            .create_sampler({.magnification = rhi::FilterMode::nearest,
                                             .minification = rhi::FilterMode::nearest})
                            .map(keep(layers.point_sampler_));
    if (made) made = device.create_compute_pipeline<shaders::frame::layer>().map(keep(layers.copy_));
    if (made && settings.wants(Layer::depth)) {
        made = device.create_compute_pipeline<shaders::frame::layer>({.distance_layer = true})
                   .map(keep(layers.distance_));
    }
    if (made && settings.wants(Layer::voxels)) {
        made = device
                   .create_compute_pipeline<shaders::frame::voxels>(
                       {.octree_levels = settings.voxels.octree_levels()})
                   .map(keep(layers.voxels_));
    }
    if (!made) return tl::unexpected(made.error());
    return layers;
}

void Layers::copy(rhi::Pass& pass, Layer layer, std::optional<rhi::View<Dimension::d2>> source,
                  const LayerSources& sources) {
    const rhi::Texture& target = textures_.at(layer);
    if (!source) {
        pass.clear(target.view());
        return;
    }
    pass.dispatch(layer == Layer::depth ? distance_ : copy_,
                  {.source = {*source, point_sampler_},
                   .layer = target.view<Dimension::d2>(),
                   .camera = sources.gbuffer.camera},
                  {.axis_plane = axis_plane(sources.camera)}, pixel_groups(size_));
}

void Layers::record(rhi::Commands& commands, const LayerSources& sources) {
    if (textures_.empty()) return;
    rhi::Pass pass = commands.pass("layers");
    for (const auto& [layer, texture] : textures_) {
        switch (layer) {
            case Layer::final:
                break;
            case Layer::radiance:
                copy(pass, layer, sources.radiance, sources);
                break;
            case Layer::direct:
                copy(pass, layer, sources.direct, sources);
                break;
            case Layer::indirect:
                copy(pass, layer, sources.indirect, sources);
                break;
            case Layer::irradiance:
                copy(pass, layer, sources.irradiance, sources);
                break;
            case Layer::specular:
                copy(pass, layer, sources.specular, sources);
                break;
            case Layer::ao:
                copy(pass, layer, sources.ao, sources);
                break;
            case Layer::emission:
                copy(pass, layer, sources.gbuffer.emission, sources);
                break;
            case Layer::albedo:
                copy(pass, layer, sources.gbuffer.base_color_metallic, sources);
                break;
            case Layer::normal:
                copy(pass, layer, sources.gbuffer.normal_roughness, sources);
                break;
            case Layer::depth:
                copy(pass, layer, sources.gbuffer.depth, sources);
                break;
            case Layer::voxels:
                if (!sources.volume) {
                    pass.clear(texture.view());
                    break;
                }
                pass.dispatch(voxels_,
                              {.radiance = {sources.volume->radiance.base, point_sampler_},
                               .emission = {sources.volume->emission.base, point_sampler_},
                               .camera = sources.gbuffer.camera,
                               .layer = texture.view<Dimension::d2>(),
                               .nodes = sources.volume->nodes},
                              {.grid_origin = sources.volume->grid.origin,
                               .voxels_per_metre = 1 / sources.volume->grid.voxel_size,
                               .radiance_unit = sources.volume->radiance_unit,
                               .emission_unit = sources.volume_emits ? sources.volume->emission_unit : 0,
                               .resolution = int32_t(sources.volume->grid.resolution)},
                              pixel_groups(size_));
                break;
        }
    }
}

}  // namespace lumo::frame
