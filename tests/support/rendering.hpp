// Small scenes through the G-buffer, the shadow map and the lighting, and every target as floats.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <glm/gtc/packing.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/lighting/lighting.hpp"
#include "techniques/shadow/shadow.hpp"

namespace lumo::testing_support {

/// Row 0 is the bottom of the picture.
struct Picture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<glm::vec4> texels = {};

    const glm::vec4& at(uint32_t x, uint32_t y) const { return texels[size_t(y) * width + x]; }
};

inline double srgb_decode(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double srgb_encode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

template <class T>
T value_of(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// The first mip as linear values.
inline Picture download(rhi::Device& device, const rhi::Texture& texture) {
    const auto bytes = value_of(device.download(texture, rhi::whole_mip(texture.desc())));
    Picture picture{texture.desc().extent.width, texture.desc().extent.height};
    picture.texels.resize(size_t(picture.width) * picture.height);
    for (size_t i = 0; i < picture.texels.size(); ++i) {
        glm::vec4& texel = picture.texels[i];
        const std::byte* from = bytes.data() + i * bytes.size() / picture.texels.size();
        switch (texture.desc().format) {
            case rhi::Format::rgba8_srgb:
            case rhi::Format::rgba8_unorm:
                for (int c = 0; c < 4; ++c) {
                    const float v = float(from[c]) / 255;
                    const bool curved = texture.desc().format == rhi::Format::rgba8_srgb && c < 3;
                    texel[c] = curved ? float(srgb_decode(double(v))) : v;
                }
                break;
            case rhi::Format::rgba16_float: {
                uint64_t bits = 0;
                std::memcpy(&bits, from, 8);
                texel = glm::unpackHalf4x16(bits);
                break;
            }
            case rhi::Format::d32_float:
                std::memcpy(&texel.x, from, 4);
                break;
            case rhi::Format::rgba32_float:
                std::memcpy(&texel, from, 16);
                break;
            default:
                throw std::runtime_error("format not read back");
        }
    }
    return picture;
}

/// Adds a parallelogram that is seen from the side of cross(right, up), uv from its lower left, v down.
inline void add_quad(scene::Scene& scene, glm::vec3 center, glm::vec3 right, glm::vec3 up,
                     scene::Material material, glm::mat4 world_from_object = glm::mat4(1)) {
    const uint32_t first = uint32_t(scene.vertices.size());
    for (int corner = 0; corner < 4; ++corner) {
        const float x = corner & 1 ? 1.0f : -1.0f;
        const float y = corner & 2 ? 1.0f : -1.0f;
        scene.vertices.push_back({.position = center + x * right + y * up,
                                  .normal = glm::cross(glm::normalize(right), glm::normalize(up)),
                                  .tangent = glm::vec4(glm::normalize(right), 1),
                                  .uv0 = {0.5f + 0.5f * x, 0.5f - 0.5f * y},
                                  .uv1 = {0.5f + 0.5f * x, 0.5f - 0.5f * y}});
    }
    const uint32_t first_index = uint32_t(scene.indices.size());
    for (const uint32_t corner : {0u, 1u, 3u, 0u, 3u, 2u}) scene.indices.push_back(first + corner);
    scene.materials.push_back(std::move(material));
    scene.meshes.push_back({.primitives = {{first_index, 6, uint32_t(scene.materials.size() - 1)}}});
    scene.instances.push_back({uint32_t(scene.meshes.size() - 1), world_from_object});
}

/// Adds a texture of one texel and returns its slot.
inline scene::TextureSlot add_texel(scene::Scene& scene, std::array<uint8_t, 4> rgba) {
    scene.images.push_back({1, 1, 4, {rgba[0], rgba[1], rgba[2], rgba[3]}});
    scene.textures.push_back({uint32_t(scene.images.size() - 1), {}});
    return {.texture = uint32_t(scene.textures.size() - 1)};
}

struct Sun {
    glm::vec3 direction{0, 1, 0};  ///< toward it
    glm::vec3 irradiance{1};
};

inline scene::Light light_of(const Sun& sun) {
    return {.intensity = sun.irradiance, .direction = -glm::normalize(sun.direction)};
}

struct RenderOptions {
    rhi::Extent size{96, 64};
    std::optional<Sun> sun = {};
    std::vector<scene::Light> lights = {};  ///< beside the sun
    glm::vec3 environment{0};
    bool diffuse_materials = false;
    shadow::Settings shadow = {};
};

struct RenderedTargets {
    Picture base_color_metallic, normal_roughness, geometric_normal_occlusion, emission, depth, shadow,
        shadow_position, radiance, direct, indirect;
    gbuffer::CameraBlock camera;
    shadow::LightCamera light;
};

inline RenderedTargets render(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera,
                              const RenderOptions& options) {
    const scene::GpuScene gpu = value_of(scene::GpuScene::create(device, scene, options.diffuse_materials));
    const scene::GeometryView geometry = gpu.view();
    const gbuffer::Needs needs = gbuffer::needs_of(geometry, options.diffuse_materials);
    auto gbuffer = value_of(gbuffer::GBuffer::create(device, options.size, needs));
    std::vector<scene::Light> lights = options.lights;
    if (options.sun) lights.insert(lights.begin(), light_of(*options.sun));
    uint32_t cameras = 0;
    for (const scene::Light& light : lights) cameras += shadow::camera_count(light);
    auto shadow = value_of(shadow::Shadow::create(
        device, options.shadow, {.alpha_mask = needs.alpha_mask, .cameras = std::max(cameras, 1u)}));
    lighting::Needs lighting_needs = lighting::blend_needs_of(geometry);
    lighting_needs.lights = !lights.empty();
    lighting_needs.emission = needs.emission;
    lighting_needs.layers = true;
    lighting_needs.diffuse_materials = options.diffuse_materials;
    auto lighting = value_of(lighting::Lighting::create(device, options.size, lighting_needs));

    RenderedTargets result;
    result.camera = gbuffer::camera_block(camera, options.size);
    rhi::Commands commands = device.begin();
    lighting::Inputs inputs{.gbuffer = gbuffer.record(commands, geometry, result.camera),
                            .environment = options.environment,
                            .geometry = geometry,
                            .eye = result.camera.eye};
    if (!lights.empty()) {
        inputs.lights = shadow.record(commands, geometry, lights);
        result.light = inputs.lights->lights[0].cameras[0];
    }
    lighting.record(commands, inputs);
    value_of(device.wait(device.submit(std::move(commands))));

    result.base_color_metallic = download(device, gbuffer.base_color_metallic());
    result.normal_roughness = download(device, gbuffer.normal_roughness());
    result.geometric_normal_occlusion = download(device, gbuffer.geometric_normal_occlusion());
    result.depth = download(device, gbuffer.depth());
    if (needs.emission) result.emission = download(device, gbuffer.emission());
    if (options.sun) result.shadow = download(device, shadow.depth());
    if (options.sun && options.shadow.position_target)
        result.shadow_position = download(device, shadow.position());
    result.radiance = download(device, lighting.radiance());
    result.direct = download(device, lighting.direct());
    result.indirect = download(device, lighting.indirect());
    return result;
}

/// The ray through the centre of a pixel, by the camera's own description: what tests compare matrices with.
struct Ray {
    glm::dvec3 origin;
    glm::dvec3 direction;  ///< unit length
    double cosine;         ///< to the camera's axis
};
inline Ray pixel_ray(const scene::Camera& camera, rhi::Extent size, uint32_t x, uint32_t y) {
    const glm::dvec3 position(camera.position);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(camera.target) - position);
    const glm::dvec3 right = glm::normalize(glm::cross(axis, glm::dvec3(camera.up)));
    const glm::dvec3 up = glm::cross(right, axis);
    const double across = (2 * (x + 0.5) / size.width - 1) * size.width / size.height;
    const double along = 2 * (y + 0.5) / size.height - 1;
    if (camera.orthographic_height) {
        const double half = 0.5 * double(*camera.orthographic_height);
        return {position + half * (across * right + along * up), axis, 1};
    }
    const double half = std::tan(0.5 * double(camera.vertical_fov));
    const glm::dvec3 direction = glm::normalize(axis + half * (across * right + along * up));
    return {position, direction, glm::dot(direction, axis)};
}

}  // namespace lumo::testing_support
