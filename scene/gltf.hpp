// glTF 2.0 files, .gltf and .glb, as a Scene.
//
// Read: nodes with their meshes, cameras and lights; every form of accessor; metallic-roughness materials
// with all their textures; KHR_texture_transform, KHR_materials_emissive_strength, KHR_materials_unlit,
// KHR_lights_punctual, KHR_mesh_quantization. Animated, skinned and morphed meshes stand at rest; points and
// lines are left out. Nothing in a file is believed: every index, offset, count, number and path is checked
// before it is used, and Limits bound what a file can cost.
#pragma once

#include <filesystem>

#include "rhi/error.hpp"
#include "scene/limits.hpp"
#include "scene/scene.hpp"

namespace lumo::scene {

struct GltfOptions {
    /// The file's lights are in lux and candela and its emission in nit, which divided by 683 lm/W are W/m²,
    /// W/sr and W/m²/sr; otherwise its numbers are taken to be radiometric already.
    bool photometric = false;
};

/// Reads the file's default scene: its `scene`, else its first, else every node. What the file merely uses
/// and lumo lacks, and what is wrong with it but can be read in one way only, is in Scene::warnings. Errors:
/// io, invalid_file, unsupported (an extension or version that the file requires), limit, out_of_memory.
Result<Scene> load_gltf(const std::filesystem::path& file, const Limits& limits = {},
                        const GltfOptions& options = {});

}  // namespace lumo::scene
