#include "techniques/shadow/shadow.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "rhi/keep.hpp"

namespace lumo::shadow {

using rhi::Dimension;

namespace {

/// 128 MiB of depth at most.
constexpr uint64_t most_texels = 32u << 20;

uint32_t affordable_resolution(const Settings& settings, uint32_t cameras) {
    uint32_t resolution = settings.resolution;
    while (resolution > 64 && uint64_t(resolution) * resolution * cameras > most_texels) resolution /= 2;
    return resolution;
}

float extent_of(const LitLight& lit, uint32_t resolution) {
    if (lit.light.kind == scene::LightKind::directional)
        return lit.cameras[0].texel_area() * float(resolution) * float(resolution);
    const bool spot = lit.light.kind == scene::LightKind::spot;
    return 2 * glm::pi<float>() * (spot ? 1 - std::cos(lit.light.outer_cone_angle) : 2.0f);
}

Block block_of(const View& view) {
    Block block{};
    block.count = int32_t(view.lights.size());
    block.size = float(view.resolution);
    // The rounding of depths: a few units of 2^-24 of the range on either side of the comparison.
    block.depth_offset = 1e-6f;
    for (size_t i = 0; i < view.lights.size(); ++i) {
        const auto& [light, first_camera, cameras, extent] = view.lights[i];
        const bool directional = light.kind == scene::LightKind::directional;
        const bool spot = light.kind == scene::LightKind::spot;
        const float outer = std::cos(light.outer_cone_angle);
        const float scale = spot ? 1 / std::max(1e-3f, std::cos(light.inner_cone_angle) - outer) : 0.0f;
        block.intensity[i] = glm::vec4(light.intensity, light.range > 0 ? 1 / light.range : 0.0f);
        block.position[i] = glm::vec4(light.position, directional ? 0.0f : 1.0f);
        block.direction[i] =
            glm::vec4(directional ? cameras[0].toward_light : glm::normalize(light.direction), 0);
        block.cone[i] = glm::vec4(scale, spot ? -outer * scale : 1, first_camera, cameras.size());
        for (size_t c = 0; c < cameras.size(); ++c) {
            block.clip_from_world[first_camera + c] = cameras[c].clip_from_world;
            block.camera_axis[first_camera + c] = glm::vec4(cameras[c].toward_light, 0);
        }
    }
    return block;
}

}  // namespace

Result<Shadow> Shadow::create(rhi::Device& device, const Settings& settings, const Needs& needs) {
    if (settings.resolution < 16 || settings.resolution > 16384)
        return fail(ErrorKind::invalid_argument, "shadow map",
                    fmt::format("{} texels a side", settings.resolution), "choose 16 to 16384");
    Shadow made;
    made.settings_ = settings;
    made.settings_.resolution = affordable_resolution(settings, needs.cameras);
    made.needs_ = needs;
    const auto make_target = [&](rhi::Texture& target, const char* name, rhi::Format format) {
        return device
            .create_texture({.name = name,
                             .dimension = Dimension::d2_array,
                             .format = format,
                             .extent = {made.settings_.resolution, made.settings_.resolution},
                             .layers = needs.cameras,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::attachment})
            .map(keep(target));
    };
    rhi::RasterState state{.depth = rhi::DepthState{}, .cull = rhi::CullMode::none};
    if (settings.position_target) state.color = {{.format = rhi::Format::rgba32_float}};

    auto done = make_target(made.depth_, "shadow.depth", rhi::Format::d32_float);
    if (settings.position_target) {
        done = done.and_then(
            [&] { return make_target(made.position_, "shadow.position", rhi::Format::rgba32_float); });
        for (const bool alpha_test : {false, true}) {
            if (alpha_test && !needs.alpha_mask) continue;
            done = done.and_then([&] {
                return device
                    .create_raster_pipeline<shaders::shadow::position>(state, {.alpha_test = alpha_test})
                    .map(keep(made.position_pipelines_[alpha_test]));
            });
        }
    } else {
        done = done.and_then([&] {
            return device.create_raster_pipeline<shaders::shadow::depth>(state).map(
                keep(made.depth_pipeline_));
        });
        if (needs.alpha_mask)
            done = done.and_then([&] {
                return device.create_raster_pipeline<shaders::shadow::masked>(state).map(
                    keep(made.masked_pipeline_));
            });
    }
    return done.map([&] { return std::move(made); });
}

View Shadow::record(rhi::Commands& commands, const scene::GeometryView& geometry,
                    std::span<const scene::Light> lights) {
    View view{.resolution = settings_.resolution,
              .lights = {},
              .depth = depth_.view<Dimension::d2_array>(),
              .position = {},
              .block = rhi::BufferSlice{}};
    if (settings_.position_target) view.position = position_.view<Dimension::d2_array>();
    uint32_t camera = 0;
    for (const scene::Light& light : lights) {
        LitLight& lit = view.lights.emplace_back(
            LitLight{light, camera, cameras_of(light, geometry.bounds, settings_.resolution)});
        lit.extent = extent_of(lit, settings_.resolution);
        for (const LightCamera& each : lit.cameras) draw(commands, geometry, each, camera++);
    }
    view.block = commands.uniform(block_of(view));
    return view;
}

void Shadow::draw(rhi::Commands& commands, const scene::GeometryView& geometry, const LightCamera& camera,
                  uint32_t layer) const {
    using CameraBlock = shaders::shadow::depth::ShadowBlock;
    const rhi::UniformBuffer block = commands.uniform(CameraBlock{.clip_from_world = camera.clip_from_world});
    const rhi::ViewRange range{.first_layer = layer, .layers = 1};
    rhi::RasterTargets targets{.depth = rhi::DepthTarget{.view = depth_.view<Dimension::d2>(range)}};
    if (settings_.position_target) targets.color.push_back({.view = position_.view<Dimension::d2>(range)});

    rhi::RasterPass pass = commands.raster_pass("shadow", targets);
    for (const scene::DrawView& draw : geometry.draws) {
        if (draw.alpha_mode == scene::AlphaMode::blend) continue;
        const bool alpha_test = draw.alpha_mode == scene::AlphaMode::mask && needs_.alpha_mask;
        const rhi::DrawIndexed triangles{.indices = geometry.indices,
                                         .count = draw.index_count,
                                         .instances = draw.instances,
                                         .first = draw.first_index};
        const auto& base_color = geometry.textures[draw.material].base_color;
        if (settings_.position_target)
            pass.draw(
                position_pipelines_[alpha_test],
                {geometry.vertices, geometry.instances, block, geometry.material(draw.material), base_color},
                {draw.first_instance}, triangles);
        else if (alpha_test)
            pass.draw(
                masked_pipeline_,
                {geometry.vertices, geometry.instances, block, geometry.material(draw.material), base_color},
                {draw.first_instance}, triangles);
        else
            pass.draw(depth_pipeline_, {geometry.vertices, geometry.instances, block}, {draw.first_instance},
                      triangles);
    }
}

}  // namespace lumo::shadow
