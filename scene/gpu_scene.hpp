// A scene in GPU memory, and the plain views of it that techniques take. An engine with its own scene fills
// the same views.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/scene.hpp"

namespace lumo::scene {

/// Textures of one material, in the roles of glTF. A role without a texture holds a 1x1 texture of neutral
/// value.
struct MaterialTextures {
    rhi::Sampled<rhi::Dimension::d2> base_color;          ///< sRGB decoded
    rhi::Sampled<rhi::Dimension::d2> metallic_roughness;  ///< G roughness, B metallic
    rhi::Sampled<rhi::Dimension::d2> normal;
    rhi::Sampled<rhi::Dimension::d2> occlusion;
    rhi::Sampled<rhi::Dimension::d2> emission;  ///< sRGB decoded
};

/// Instances of triangles of one material, drawn by one call. Blended ones come singly, so that they can be
/// sorted.
struct DrawView {
    uint32_t first_index = 0;
    uint32_t index_count = 0;
    uint32_t first_instance = 0;  ///< into GeometryView::instances
    uint32_t instances = 1;
    uint32_t material = 0;  ///< into GeometryView::materials and textures
    bool double_sided = false;
    bool mirrored = false;  ///< its instances turn the winding
    AlphaMode alpha_mode = AlphaMode::opaque;
    bool emits = false;
    bool unlit = false;
    bool normal_mapped = false;
    glm::vec3 center{0};  ///< of its world bounds, for sorting
};

inline constexpr uint64_t material_stride = 256;  ///< bytes; meets every device's alignment of uniform blocks

/// Everything that rasterizers and voxelizers read. Layouts: shaders/common/geometry.glsl and material.glsl.
struct GeometryView {
    rhi::BufferSlice vertices;
    rhi::BufferSlice indices;  ///< uint32
    rhi::BufferSlice instances;
    rhi::BufferSlice materials;                  ///< blocks of material.glsl, material_stride bytes apart
    std::span<const MaterialTextures> textures;  ///< by material
    std::span<const DrawView> draws;             ///< sorted by alpha mode, then material
    Bounds bounds;                               ///< world

    rhi::UniformBuffer material(uint32_t index) const {
        return rhi::BufferSlice{materials.buffer, materials.offset + index * material_stride,
                                material_stride};
    }
};

/// Owns a scene's buffers and textures.
class GpuScene {
  public:
    /// Uploads what the scene's drawn materials need; mips are made on the CPU (scene/mips.hpp), so that they
    /// are the same on every device. With `diffuse_materials`, materials are not metallic and not normal
    /// mapped, and textures other than base colour and emission stay out. Errors: out_of_memory, limit (a
    /// buffer beyond the device's storage range, an image beyond its largest texture).
    static Result<GpuScene> create(rhi::Device& device, const Scene& scene, bool diffuse_materials = false);

    /// Valid as long as this object lives, also when it is moved.
    GeometryView view() const;

  private:
    rhi::Buffer vertices_;
    rhi::Buffer indices_;
    rhi::Buffer instances_;
    rhi::Buffer materials_;
    std::vector<rhi::Texture> textures_;
    std::vector<rhi::Sampler> samplers_;
    std::vector<MaterialTextures> material_textures_;
    std::vector<DrawView> draws_;
    Bounds bounds_;
};

}  // namespace lumo::scene
