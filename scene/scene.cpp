#include "scene/scene.hpp"

#include <algorithm>

namespace lumo::scene {

uint64_t Scene::triangle_count() const {
    uint64_t indices_drawn = 0;
    for (const Instance& instance : instances)
        for (const Primitive& primitive : meshes[instance.mesh].primitives)
            indices_drawn += primitive.index_count;
    return indices_drawn / 3;
}

Bounds world_bounds(const Scene& scene) {
    const auto add_vertices = [&](Bounds& bounds, const Mesh& mesh, const glm::mat4& m) {
        for (const Primitive& primitive : mesh.primitives)
            for (uint32_t k = 0; k < primitive.index_count; ++k)
                bounds.add(m *
                           glm::vec4(scene.vertices[scene.indices[primitive.first_index + k]].position, 1));
    };
    const auto turns_by_right_angles = [](const glm::mat4& m) {
        const auto along_one_axis = [](glm::vec3 v) { return (v.x != 0) + (v.y != 0) + (v.z != 0) == 1; };
        return along_one_axis(m[0]) && along_one_axis(m[1]) && along_one_axis(m[2]);
    };

    std::vector<Bounds> boxes(scene.meshes.size());
    std::vector<uint64_t> index_counts(scene.meshes.size());
    for (size_t i = 0; i < boxes.size(); ++i) {
        add_vertices(boxes[i], scene.meshes[i], glm::mat4(1));
        for (const Primitive& primitive : scene.meshes[i].primitives)
            index_counts[i] += primitive.index_count;
    }

    // The box of a box turned by right angles is exact; any other instance is gone through vertex by vertex,
    // until a scene of very many makes that too slow.
    uint64_t vertices_left = uint64_t(1) << 28;
    Bounds bounds;
    for (const Instance& instance : scene.instances) {
        const Bounds& box = boxes[instance.mesh];
        const glm::mat4& m = instance.world_from_object;
        if (box.empty()) continue;
        if (!turns_by_right_angles(m) && index_counts[instance.mesh] <= vertices_left) {
            vertices_left -= index_counts[instance.mesh];
            add_vertices(bounds, scene.meshes[instance.mesh], m);
            continue;
        }
        for (int corner = 0; corner < 8; ++corner)
            bounds.add(m * glm::vec4(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                     corner & 4 ? box.max.z : box.min.z, 1));
    }
    return bounds;
}

}  // namespace lumo::scene
