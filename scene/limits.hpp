// How much a file from outside may make lumo allocate or walk. Every number of the loader stands here.
#pragma once

#include <cstdint>

#include "scene/image.hpp"

namespace lumo::scene {

struct Limits {
    ImageLimits images = {};                        ///< max_bytes counts all images of a scene together
    uint64_t max_json_bytes = uint64_t(64) << 20;   ///< of a .gltf file or a GLB's JSON chunk
    uint32_t max_json_depth = 64;                   ///< objects and arrays inside each other
    uint64_t max_json_values = 8'000'000;           ///< numbers, strings, objects, arrays
    uint64_t max_buffer_bytes = uint64_t(4) << 30;  ///< of all buffers together, and of a .glb file
    uint32_t max_node_depth = 1024;
    uint64_t max_instances = 1'000'000;
    uint32_t max_nodes = 1'000'000;
    uint32_t max_objects = 65'536;              ///< of any other kind: meshes, accessors, materials, …
    uint64_t max_vertices = uint64_t(1) << 24;  ///< of a scene, while it is loaded
    uint64_t max_indices = uint64_t(1) << 26;   ///< of a scene
    uint64_t max_unbacked_elements = uint64_t(1) << 20;  ///< of an accessor that no buffer view backs
};

}  // namespace lumo::scene
