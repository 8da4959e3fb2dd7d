// Small scenes through the voxel techniques, and every volume as floats.
#pragma once

#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <glm/gtc/packing.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "scene/builtin/geometry.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/voxels/octree_statistics.hpp"
#include "tests/support/rendering.hpp"
#include "tests/support/voxelizer.hpp"

namespace lumo::testing_support {

/// A mip of a volume, x fastest.
struct VolumeTexels {
    int side = 0;                       ///< along y and z; along x it is a multiple of this in atlases
    int width = 0;                      ///< along x
    std::vector<std::byte> bytes = {};  ///< as stored, for comparison to the bit
    std::vector<glm::vec4> texels = {};

    const glm::vec4& at(glm::ivec3 v) const {
        return texels[(size_t(v.z) * size_t(side) + size_t(v.y)) * size_t(width) + size_t(v.x)];
    }
};

inline VolumeTexels read_volume(rhi::Device& device, const rhi::Texture& texture, uint32_t mip = 0) {
    VolumeTexels volume;
    const rhi::Extent extent = rhi::mip_extent(texture.desc().extent, mip);
    volume.side = int(extent.height);
    volume.width = int(extent.width);
    volume.bytes = value_of(device.download(texture, rhi::whole_mip(texture.desc(), mip)));
    volume.texels.resize(size_t(extent.width) * extent.height * extent.depth);
    const size_t stride = volume.bytes.size() / volume.texels.size();
    for (size_t i = 0; i < volume.texels.size(); ++i) {
        const std::byte* from = volume.bytes.data() + i * stride;
        glm::vec4& texel = volume.texels[i];
        switch (texture.desc().format) {
            case rhi::Format::r8_unorm:
                texel.x = float(from[0]) / 255;
                break;
            case rhi::Format::rgba8_unorm:
                for (int c = 0; c < 4; ++c) texel[c] = float(from[c]) / 255;
                break;
            case rhi::Format::rgba16_float: {
                uint64_t bits = 0;
                std::memcpy(&bits, from, sizeof bits);
                texel = glm::unpackHalf4x16(bits);
                break;
            }
            case rhi::Format::r32_uint: {
                uint32_t count = 0;
                std::memcpy(&count, from, sizeof count);
                texel.x = float(count);
                break;
            }
            default:
                throw std::runtime_error("format not read back");
        }
    }
    return volume;
}

/// decode_area of shaders/common/voxel_grid.glsl, in voxel faces.
inline double decode_area(float stored) { return 16 * double(stored) * double(stored); }

inline scene::Material diffuse(glm::vec3 albedo, glm::vec3 emission = glm::vec3(0)) {
    return {.base_color = glm::vec4(albedo, 1), .metallic = 0, .roughness = 1, .emission = emission};
}

/// Adds geometry of one material as an instance of its own.
inline void add(scene::Scene& scene, const scene::builtin::Geometry& geometry, scene::Material material,
                const glm::mat4& world_from_object = glm::mat4(1)) {
    const auto first_vertex = uint32_t(scene.vertices.size());
    const auto first_index = uint32_t(scene.indices.size());
    scene.vertices.insert(scene.vertices.end(), geometry.vertices.begin(), geometry.vertices.end());
    for (const uint32_t index : geometry.indices) scene.indices.push_back(first_vertex + index);
    scene.materials.push_back(std::move(material));
    scene.meshes.push_back({.primitives = {{.first_index = first_index,
                                            .index_count = uint32_t(geometry.indices.size()),
                                            .material = uint32_t(scene.materials.size() - 1)}}});
    scene.instances.push_back(
        {.mesh = uint32_t(scene.meshes.size() - 1), .world_from_object = world_from_object});
}

/// A triangle with corners as they are, whatever its shape.
inline scene::builtin::Geometry triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 doubled = glm::cross(b - a, c - a);
    const glm::vec3 normal = glm::length(doubled) > 0 ? glm::normalize(doubled) : glm::vec3(0, 1, 0);
    scene::builtin::Geometry geometry;
    for (const glm::vec3& p : {a, b, c}) geometry.vertices.push_back({.position = p, .normal = normal});
    geometry.indices = {0, 1, 2};
    return geometry;
}

/// The built-in scene without its images: what must be equal to the bit.
inline scene::Scene without_textures(scene::Scene scene) {
    for (scene::Material& material : scene.materials) {
        material.base_color_texture.reset();
        material.metallic_roughness_texture.reset();
        material.normal_texture.reset();
        material.occlusion_texture.reset();
        material.emission_texture.reset();
    }
    scene.textures.clear();
    scene.images.clear();
    return scene;
}

struct VoxelOptions {
    std::optional<scene::Bounds> bounds = {};  ///< of the grid in place of the scene's
    std::optional<voxels::Grid> grid = {};  ///< of the resolution, in place of one that is fitted to bounds
    uint32_t resolution = 32;
    std::optional<Sun> sun = {};
    std::vector<scene::Light> lights = {};  ///< beside the sun
    uint32_t shadow_resolution = 512;
    bool normals = false;
    voxels::Range range = voxels::Range::ldr;
    voxels::MipKind mips = voxels::MipKind::anisotropic;
    voxels::VoxelizerKind voxelizer = voxels::VoxelizerKind::compute;
    voxels::Storage storage = voxels::Storage::dense;
};

/// The volume of a scene, ready to read.
struct Voxelized {
    voxels::Volume volume;
    voxels::Grid grid;
    shadow::LightCamera light = {};

    uint32_t side() const { return grid.resolution; }
};

inline float highest_emission(const scene::Scene& scene) {
    float highest = 0;
    for (const scene::Material& m : scene.materials)
        highest = std::max({highest, m.emission.r, m.emission.g, m.emission.b});
    return highest;
}

inline Voxelized voxelize(rhi::Device& device, const scene::Scene& scene, const VoxelOptions& options) {
    const scene::GpuScene gpu = value_of(scene::GpuScene::create(device, scene, true));
    scene::GeometryView geometry = gpu.view();
    if (options.bounds) geometry.bounds = *options.bounds;
    std::vector<scene::Light> lights = options.lights;
    if (options.sun) lights.insert(lights.begin(), light_of(*options.sun));
    voxels::Needs needs{.emission = highest_emission(scene) > 0,
                        .lights = !lights.empty(),
                        .several_lights = options.sun ? lights.size() > 1 : !lights.empty(),
                        .normals = options.normals,
                        .triangles = voxels::count_triangles(geometry),
                        .draws = uint32_t(geometry.draws.size())};
    for (const scene::Material& material : scene.materials) {
        needs.alpha_mask |= material.alpha_mode == scene::AlphaMode::mask;
        needs.translucent |= material.alpha_mode == scene::AlphaMode::blend;
    }
    if (options.storage == voxels::Storage::octree)
        needs.octree =
            value_of(voxels::count_octree(device, geometry, options.resolution, options.voxelizer));
    Voxelized result{.volume = value_of(voxels::Volume::create(device,
                                                               {.resolution = options.resolution,
                                                                .mips = options.mips,
                                                                .voxelizer = options.voxelizer,
                                                                .storage = options.storage,
                                                                .range = options.range},
                                                               needs)),
                     .grid = options.grid.value_or(voxels::fit_grid(geometry.bounds, options.resolution))};
    uint32_t cameras = 0;
    for (const scene::Light& light : lights) cameras += shadow::camera_count(light);
    auto shadow =
        value_of(shadow::Shadow::create(device, {.resolution = options.shadow_resolution},
                                        {.alpha_mask = needs.alpha_mask, .cameras = std::max(cameras, 1u)}));

    rhi::Commands commands = device.begin();
    std::optional<shadow::View> seen;
    if (!lights.empty()) {
        seen = shadow.record(commands, geometry, lights);
        result.light = seen->lights[0].cameras[0];
    }
    result.volume.voxelize(commands, geometry, highest_emission(scene), options.grid);
    result.volume.inject(commands, seen ? &*seen : nullptr);
    value_of(device.wait(device.submit(std::move(commands))));
    return result;
}

inline VoxelMap<bool> occupancy_of(const VolumeTexels& albedo) {
    VoxelMap<bool> occupied(uint32_t(albedo.side), false);
    for (size_t i = 0; i < albedo.texels.size(); ++i) occupied.values[i] = albedo.texels[i].a > 0;
    return occupied;
}

}  // namespace lumo::testing_support
