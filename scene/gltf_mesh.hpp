// Mesh primitives as triangles. A part of the loader.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "rhi/error.hpp"
#include "scene/gltf_bytes.hpp"
#include "scene/gltf_document.hpp"
#include "scene/limits.hpp"
#include "scene/scene.hpp"
#include "scene/tangents.hpp"

namespace lumo::scene::gltf {

/// The accessors of a primitive's vertices; -1 where it has none.
struct Attributes {
    int position = -1, normal = -1, tangent = -1, uv0 = -1, uv1 = -1, color = -1;

    bool operator<(const Attributes& o) const {
        return std::tie(position, normal, tangent, uv0, uv1, color) <
               std::tie(o.position, o.normal, o.tangent, o.uv0, o.uv1, o.color);
    }
};

/// Appends primitives to a scene. Primitives with the same attributes share their vertices, as long as none
/// of these has to be generated.
class MeshBuilder {
  public:
    /// All outlive the object.
    MeshBuilder(Document& document, const Bytes& bytes, const Limits& limits, Scene& scene);

    /// The primitive's triangles, with a material still to be set; nothing, and a warning, where there are
    /// none. where names it in errors. normal_map says how its normal map is read, if it has one. Errors:
    /// invalid_file, limit.
    Result<std::optional<Primitive>> add(const tinygltf::Primitive& primitive, const std::string& where,
                                         const std::optional<TangentUv>& normal_map);

  private:
    // The vertices of one set of attributes: in the scene from `first`, once a primitive has placed them
    // there.
    struct VertexArray {
        std::vector<Vertex> vertices;
        std::optional<uint32_t> first;
        bool has_normals = false;  // a unit vector each
        bool has_tangents = false;
    };

    Result<Attributes> attributes_of(const tinygltf::Primitive& primitive, const std::string& where);
    Result<std::vector<uint32_t>> triangles_of(const tinygltf::Primitive& primitive, const std::string& where,
                                               uint64_t vertex_count);
    Result<VertexArray*> decode(const Attributes& attributes);
    uint32_t place(VertexArray& array);
    Result<void> make_room(uint64_t vertices, uint64_t indices, const std::string& where) const;

    Document& document_;
    const Bytes& bytes_;
    const Limits& limits_;
    Scene& scene_;
    std::vector<uint32_t> view_uses_;  // how many accessors are in each buffer view
    std::map<Attributes, VertexArray> arrays_;
    uint64_t unplaced_ = 0;  // vertices in arrays_
};

}  // namespace lumo::scene::gltf
