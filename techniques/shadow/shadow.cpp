#include "techniques/shadow/shadow.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

namespace lumo::shadow {

using rhi::Dimension;

LightCamera fit_light(const scene::Bounds& bounds, glm::vec3 direction_to_light, uint32_t resolution) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(direction_to_light));
    const glm::dvec3 helper = std::abs(z.y) < 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
    const glm::dmat3 light_from_world = glm::transpose(glm::dmat3(x, glm::cross(z, x), z));

    const scene::Bounds box = bounds.empty() ? scene::Bounds{glm::vec3(-1), glm::vec3(1)} : bounds;
    const glm::dvec3 center = light_from_world * (0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)));
    const glm::dvec3 half_diagonal = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min));
    glm::dvec3 extent(0);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            extent[row] += std::abs(light_from_world[column][row]) * half_diagonal[column];
    // A flat scene still gets a volume.
    const double least = std::max(1e-3 * std::max({extent.x, extent.y, extent.z}), 1e-6);
    extent = glm::max(extent, glm::dvec3(least));
    extent.x *= resolution / (resolution - 4.0);
    extent.y *= resolution / (resolution - 4.0);
    extent.z *= 1.001;

    // z points to the light, depth away from it.
    glm::dmat4 clip_from_light(1);
    clip_from_light[0][0] = 1 / extent.x;
    clip_from_light[1][1] = 1 / extent.y;
    clip_from_light[2][2] = -0.5 / extent.z;
    clip_from_light[3] =
        glm::dvec4(-center.x / extent.x, -center.y / extent.y, 0.5 + 0.5 * center.z / extent.z, 1);
    const glm::dmat4 clip_from_world = clip_from_light * glm::dmat4(light_from_world);
    return {.clip_from_world = glm::mat4(clip_from_world),
            .world_from_clip = glm::mat4(glm::inverse(clip_from_world)),
            .direction_to_light = glm::vec3(z),
            .texel_size = glm::vec2(2 * extent.x / resolution, 2 * extent.y / resolution)};
}

Result<Shadow> Shadow::create(rhi::Device& device, const Settings& settings, const Needs& needs) {
    if (settings.resolution < 16 || settings.resolution > 16384)
        return fail(ErrorKind::invalid_argument, "shadow map",
                    fmt::format("{} texels a side", settings.resolution), "choose 16 to 16384");
    Shadow made;
    made.settings_ = settings;
    made.needs_ = needs;
    const auto make_target = [&](rhi::Texture& target, const char* name, rhi::Format format) {
        return device
            .create_texture({.name = name,
                             .format = format,
                             .extent = {settings.resolution, settings.resolution},
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::attachment})
            .map([&](rhi::Texture texture) { target = std::move(texture); });
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
                    .map([&](auto pipeline) { made.position_pipelines_[alpha_test] = std::move(pipeline); });
            });
        }
    } else {
        done = done.and_then([&] {
            return device.create_raster_pipeline<shaders::shadow::depth>(state).map(
                [&](auto pipeline) { made.depth_pipeline_ = std::move(pipeline); });
        });
        if (needs.alpha_mask)
            done = done.and_then([&] {
                return device.create_raster_pipeline<shaders::shadow::masked>(state).map(
                    [&](auto pipeline) { made.masked_pipeline_ = std::move(pipeline); });
            });
    }
    return done.map([&] { return std::move(made); });
}

View Shadow::record(rhi::Commands& commands, const scene::GeometryView& geometry,
                    glm::vec3 direction_to_light) {
    const LightCamera camera = fit_light(geometry.bounds, direction_to_light, settings_.resolution);
    // Taps reach 1.5 texels along each axis (shaders/common/shadow.glsl). What remains is the rounding of
    // depths, a few units of 2^-24 of the range on either side of the comparison.
    const Block block{.clip_from_world = camera.clip_from_world,
                      .world_from_clip = camera.world_from_clip,
                      .direction = glm::vec4(camera.direction_to_light, 0),
                      .size = float(settings_.resolution),
                      .normal_offset = 1.5f * glm::length(camera.texel_size),
                      .depth_offset = 1e-6f};
    View view{.resolution = settings_.resolution,
              .camera = camera,
              .texel_area = camera.texel_size.x * camera.texel_size.y,
              .depth = depth_.view<Dimension::d2>(),
              .position = {},
              .block = commands.uniform(block)};
    rhi::RasterTargets targets{.depth = rhi::DepthTarget{.view = view.depth}};
    if (settings_.position_target) {
        view.position = position_.view<Dimension::d2>();
        targets.color.push_back({.view = *view.position});
    }

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
            pass.draw(position_pipelines_[alpha_test],
                      {geometry.vertices, geometry.instances, view.block, geometry.material(draw.material),
                       base_color},
                      {draw.first_instance}, triangles);
        else if (alpha_test)
            pass.draw(masked_pipeline_,
                      {geometry.vertices, geometry.instances, view.block, geometry.material(draw.material),
                       base_color},
                      {draw.first_instance}, triangles);
        else
            pass.draw(depth_pipeline_, {geometry.vertices, geometry.instances, view.block},
                      {draw.first_instance}, triangles);
    }
    return view;
}

}  // namespace lumo::shadow
