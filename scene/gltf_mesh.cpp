#include "scene/gltf_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <string_view>

#include "scene/gltf_accessor.hpp"
#include "scene/printable.hpp"

namespace lumo::scene::gltf {
namespace {

tl::unexpected<Error> invalid(const Document& document, std::string message) {
    return fail(ErrorKind::invalid_file, document.file, std::move(message), "export the file again");
}

tl::unexpected<Error> located(const std::string& where, Error error) {
    error.message = where + ": " + error.message;
    return tl::unexpected<Error>(std::move(error));
}

bool is_any_of(int value, std::initializer_list<int> values) {
    return std::ranges::find(values, value) != values.end();
}

enum class Fit { yes, only_quantized, no };

// glTF 2.0, section 3.7.2.1 ("Meshes: Overview"), and the tables of KHR_mesh_quantization.
Fit format_fit(std::string_view attribute, const tinygltf::Accessor& accessor) {
    constexpr int byte = TINYGLTF_COMPONENT_TYPE_BYTE, ubyte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                  word = TINYGLTF_COMPONENT_TYPE_SHORT, uword = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    const int type = accessor.componentType;
    const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const bool is_short = is_any_of(type, {byte, ubyte, word, uword});
    const auto plain_if = [](bool fits) { return fits ? Fit::yes : Fit::no; };
    if (attribute == "POSITION") {
        if (accessor.type != TINYGLTF_TYPE_VEC3) return Fit::no;
        return is_short ? Fit::only_quantized : plain_if(is_float);
    }
    if (attribute == "NORMAL" || attribute == "TANGENT") {
        if (accessor.type != (attribute == "NORMAL" ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4))
            return Fit::no;
        const bool is_signed_unit = accessor.normalized && is_any_of(type, {byte, word});
        return is_signed_unit ? Fit::only_quantized : plain_if(is_float);
    }
    const bool is_unit = accessor.normalized && is_any_of(type, {ubyte, uword});
    if (attribute == "COLOR_0")
        return plain_if(is_any_of(accessor.type, {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4}) &&
                        (is_float || is_unit));
    if (accessor.type != TINYGLTF_TYPE_VEC2) return Fit::no;
    if (is_float || is_unit) return Fit::yes;
    return is_short ? Fit::only_quantized : Fit::no;
}

bool is_known_attribute(std::string_view name) {
    if (name.starts_with('_')) return true;
    for (const std::string_view prefix : {"TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"}) {
        if (!name.starts_with(prefix)) continue;
        const std::string_view number = name.substr(prefix.size());
        const bool has_leading_zero = number.size() > 1 && number[0] == '0';
        return !number.empty() && !has_leading_zero && number.find_first_not_of("0123456789") == number.npos;
    }
    return is_any_of(0, {name.compare("POSITION"), name.compare("NORMAL"), name.compare("TANGENT")});
}

// Counter-clockwise, from any of the three modes of triangles (glTF 2.0, section 3.7.2.1).
std::vector<uint32_t> as_triangle_list(const std::vector<uint32_t>& indices, int mode) {
    const size_t count = indices.size();
    if (mode == TINYGLTF_MODE_TRIANGLES)
        return {indices.begin(), indices.begin() + std::ptrdiff_t(count - count % 3)};
    std::vector<uint32_t> list;
    if (count < 3) return list;
    list.reserve((count - 2) * 3);
    for (size_t i = 0; i + 2 < count; ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            list.insert(list.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
        else
            list.insert(list.end(), {indices[i + 1], indices[i + 2], indices[0]});
    }
    return list;
}

glm::vec3 face_normal(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::dvec3 area = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    const double length = glm::length(area);
    return length > 0 ? glm::vec3(area / length) : glm::vec3(0, 1, 0);
}

// The vertices that a triangle list uses, whose indices are made to count these only.
std::vector<Vertex> gather(const Vertex* source, std::vector<uint32_t>& indices) {
    std::vector<uint32_t> used = indices;
    std::ranges::sort(used);
    used.erase(std::ranges::unique(used).begin(), used.end());
    std::vector<Vertex> vertices(used.size());
    std::ranges::transform(used, vertices.begin(), [&](uint32_t index) { return source[index]; });
    for (uint32_t& index : indices) index = uint32_t(std::ranges::lower_bound(used, index) - used.begin());
    return vertices;
}

// Gives every triangle its own vertices and its own normal.
void flatten(std::vector<Vertex>& vertices, std::vector<uint32_t>& indices) {
    std::vector<Vertex> corners(indices.size());
    for (size_t k = 0; k < indices.size(); k += 3) {
        for (size_t i = 0; i < 3; ++i) corners[k + i] = vertices[indices[k + i]];
        const glm::vec3 normal =
            face_normal(corners[k].position, corners[k + 1].position, corners[k + 2].position);
        for (size_t i = 0; i < 3; ++i) corners[k + i].normal = normal;
    }
    vertices = std::move(corners);
    std::iota(indices.begin(), indices.end(), 0u);
}

}  // namespace

MeshBuilder::MeshBuilder(Document& document, const Bytes& bytes, const Limits& limits, Scene& scene)
    : document_(document),
      bytes_(bytes),
      limits_(limits),
      scene_(scene),
      view_uses_(document.model.bufferViews.size()) {
    for (const tinygltf::Accessor& accessor : document.model.accessors)
        if (accessor.bufferView >= 0) ++view_uses_[size_t(accessor.bufferView)];
}

Result<void> MeshBuilder::make_room(uint64_t vertices, uint64_t indices, const std::string& where) const {
    if (vertices > limits_.max_vertices ||
        scene_.vertices.size() + unplaced_ > limits_.max_vertices - vertices)
        return fail(ErrorKind::limit, document_.file,
                    fmt::format("{} brings the vertices beyond the limit of {}", where, limits_.max_vertices),
                    "split or simplify the scene");
    if (indices > limits_.max_indices || scene_.indices.size() > limits_.max_indices - indices)
        return fail(ErrorKind::limit, document_.file,
                    fmt::format("{} brings the indices beyond the limit of {}", where, limits_.max_indices),
                    "split or simplify the scene");
    return {};
}

Result<Attributes> MeshBuilder::attributes_of(const tinygltf::Primitive& primitive,
                                              const std::string& where) {
    Attributes attributes;
    const std::array<std::pair<std::string_view, int*>, 6> known = {{{"POSITION", &attributes.position},
                                                                     {"NORMAL", &attributes.normal},
                                                                     {"TANGENT", &attributes.tangent},
                                                                     {"TEXCOORD_0", &attributes.uv0},
                                                                     {"TEXCOORD_1", &attributes.uv1},
                                                                     {"COLOR_0", &attributes.color}}};
    const auto& used = document_.model.extensionsUsed;
    const bool quantized = std::ranges::find(used, "KHR_mesh_quantization") != used.end();
    std::optional<uint64_t> count;
    for (const auto& [name, target] : known) {
        const auto found = primitive.attributes.find(std::string(name));
        if (found == primitive.attributes.end()) continue;
        const tinygltf::Accessor& accessor = document_.model.accessors[size_t(found->second)];
        const std::string named = fmt::format("{}.{} (accessors[{}])", where, name, found->second);
        const Fit fit = format_fit(name, accessor);
        if (fit == Fit::no)
            return invalid(document_,
                           fmt::format("{} has {} numbers of component type {}{}, which glTF does not allow",
                                       named, component_count(accessor), accessor.componentType,
                                       accessor.normalized ? " (normalized)" : ""));
        if (fit == Fit::only_quantized && !quantized)
            document_.warnings.add(named + " needs KHR_mesh_quantization, which the file does not declare");
        if (count.value_or(accessor.count) != accessor.count)
            return invalid(document_,
                           fmt::format("{} has {} elements, POSITION has {}", named, accessor.count, *count));
        count = accessor.count;
        *target = found->second;
    }
    int joints = 0, weights = 0;
    for (const auto& [name, index] : primitive.attributes) {
        const tinygltf::Accessor& accessor = document_.model.accessors[size_t(index)];
        const std::string named = where + "." + printable(name, 60);
        joints += name.starts_with("JOINTS_");
        weights += name.starts_with("WEIGHTS_");
        if (!is_known_attribute(name)) document_.warnings.add(named + " is not in glTF 2.0 and is ignored");
        if (accessor.bufferView >= 0) {
            const tinygltf::BufferView& view = document_.model.bufferViews[size_t(accessor.bufferView)];
            const size_t stride = size_t(std::max(accessor.ByteStride(view), 0));
            if ((view.byteOffset + accessor.byteOffset) % 4 != 0 || stride % 4 != 0)
                document_.warnings.add(named + " is not aligned to 4 bytes");
            if (view.byteStride == 0 && view_uses_[size_t(accessor.bufferView)] > 1)
                document_.warnings.add(fmt::format("{} shares bufferViews[{}], which has no byteStride",
                                                   named, accessor.bufferView));
        }
        if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
            document_.warnings.add(named + " is of 32-bit integers, which no attribute may be");
        if (accessor.count != count.value_or(accessor.count))
            document_.warnings.add(
                fmt::format("{} has {} elements, POSITION has {}", named, accessor.count, *count));
    }
    if (joints != weights)
        document_.warnings.add(
            fmt::format("{} has {} sets of JOINTS and {} of WEIGHTS", where, joints, weights));
    if (attributes.tangent >= 0 && attributes.normal < 0) {
        document_.warnings.add(where + " has TANGENT without NORMAL: both are generated");
        attributes.tangent = -1;
    }
    return attributes;
}

Result<std::vector<uint32_t>> MeshBuilder::triangles_of(const tinygltf::Primitive& primitive,
                                                        const std::string& where, uint64_t vertex_count) {
    const auto& accessors = document_.model.accessors;
    const uint64_t count = primitive.indices >= 0 ? accessors[size_t(primitive.indices)].count : vertex_count;
    const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    const uint64_t triangle_count = is_list ? count / 3 : count >= 3 ? count - 2 : 0;
    if (count < 3 || (is_list && count % 3 != 0))
        document_.warnings.add(fmt::format("{} has {} indices, of which {} make triangles", where, count,
                                           is_list ? triangle_count * 3 : 0));
    if (auto room = make_room(0, triangle_count * 3, where); !room) return tl::unexpected(room.error());
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        auto read = read_indices(document_, bytes_, primitive.indices);
        if (!read) return located(where, read.error());
        indices = std::move(*read);
        const int type = accessors[size_t(primitive.indices)].componentType;
        const uint32_t restart = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 0xffu
                                 : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xffffu
                                                                                  : 0xffffffffu;
        if (std::ranges::find(indices, restart) != indices.end())
            document_.warnings.add(
                fmt::format("{} has index {}, which glTF keeps for restarts", where, restart));
        const auto outside =
            std::ranges::find_if(indices, [&](uint32_t index) { return index >= vertex_count; });
        if (outside != indices.end())
            return invalid(
                document_,
                fmt::format("{} has index {} at {} of accessors[{}], but there are {} vertices", where,
                            *outside, outside - indices.begin(), primitive.indices, vertex_count));
    } else {
        indices.resize(vertex_count);
        std::iota(indices.begin(), indices.end(), 0u);
    }
    return as_triangle_list(indices, primitive.mode);
}

Result<MeshBuilder::VertexArray*> MeshBuilder::decode(const Attributes& attributes) {
    if (const auto found = arrays_.find(attributes); found != arrays_.end()) return &found->second;
    std::vector<Vertex> vertices(document_.model.accessors[size_t(attributes.position)].count);
    // Calls set(vertex, element) with each element's numbers.
    const auto read = [&](int accessor, auto set) -> Result<void> {
        if (accessor < 0) return {};
        const auto values = read_floats(document_, bytes_, accessor);
        if (!values) return tl::unexpected(values.error());
        const uint32_t components = component_count(document_.model.accessors[size_t(accessor)]);
        for (size_t i = 0; i < vertices.size(); ++i) set(vertices[i], values->data() + i * components);
        return {};
    };
    const auto name = [](int accessor) { return fmt::format("accessors[{}]", accessor); };

    uint64_t zero_normals = 0, long_normals = 0, bad_signs = 0, bright_colors = 0;
    const bool has_alpha = attributes.color >= 0 &&
                           document_.model.accessors[size_t(attributes.color)].type == TINYGLTF_TYPE_VEC4;
    const std::array results = {
        read(attributes.position,
             [](Vertex& v, const float* p) {
                 v.position = {p[0], p[1], p[2]};
             }),
        read(attributes.normal,
             [&](Vertex& v, const float* p) {
                 const glm::dvec3 normal(p[0], p[1], p[2]);
                 const double length = glm::length(normal);
                 // A byte's steps leave up to one percent.
                 if (length == 0)
                     ++zero_normals;
                 else if (std::abs(length - 1) > 0.02)
                     ++long_normals;
                 if (length > 0) v.normal = normal / length;
             }),
        read(attributes.tangent,
             [&](Vertex& v, const float* p) {
                 const glm::dvec3 tangent(p[0], p[1], p[2]);
                 const double length = glm::length(tangent);
                 if (length > 0) v.tangent = glm::vec4(tangent / length, p[3] < 0 ? -1 : 1);
                 if (length == 0 || std::abs(p[3]) != 1) ++bad_signs;
             }),
        read(attributes.uv0,
             [](Vertex& v, const float* p) {
                 v.uv0 = {p[0], p[1]};
             }),
        read(attributes.uv1,
             [](Vertex& v, const float* p) {
                 v.uv1 = {p[0], p[1]};
             }),
        read(attributes.color,
             [&](Vertex& v, const float* p) {
                 const glm::vec4 color(p[0], p[1], p[2], has_alpha ? p[3] : 1);
                 v.color = glm::clamp(color, 0.0f, 1.0f);
                 if (v.color != color) ++bright_colors;
             }),
    };
    for (const Result<void>& result : results)
        if (!result) return tl::unexpected(result.error());
    if (zero_normals > 0)
        document_.warnings.add(fmt::format("{} has {} normals of length 0: flat normals are used instead",
                                           name(attributes.normal), zero_normals));
    if (long_normals > 0)
        document_.warnings.add(fmt::format("{} has {} normals that are not of unit length: normalized",
                                           name(attributes.normal), long_normals));
    if (bad_signs > 0)
        document_.warnings.add(fmt::format("{} has {} tangents of length 0 or with a w other than 1 and -1",
                                           name(attributes.tangent), bad_signs));
    if (bright_colors > 0)
        document_.warnings.add(
            fmt::format("{} has {} colours outside 0 to 1: clamped", name(attributes.color), bright_colors));
    const bool has_normals = attributes.normal >= 0 && zero_normals == 0;
    unplaced_ += vertices.size();
    VertexArray& array = arrays_[attributes];
    array.vertices = std::move(vertices);
    array.has_normals = has_normals;
    array.has_tangents = has_normals && attributes.tangent >= 0;
    return &array;
}

uint32_t MeshBuilder::place(VertexArray& array) {
    if (!array.first) {
        array.first = uint32_t(scene_.vertices.size());
        scene_.vertices.insert(scene_.vertices.end(), array.vertices.begin(), array.vertices.end());
        unplaced_ -= array.vertices.size();
        array.vertices = {};
    }
    return *array.first;
}

Result<std::optional<Primitive>> MeshBuilder::add(const tinygltf::Primitive& primitive,
                                                  const std::string& where,
                                                  const std::optional<TangentUv>& normal_map) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        document_.warnings.add(where +
                               (primitive.mode == TINYGLTF_MODE_POINTS ? " is of points" : " is of lines") +
                               ", which are not drawn");
        return std::nullopt;
    }
    const auto attributes = attributes_of(primitive, where);
    if (!attributes) return tl::unexpected(attributes.error());
    if (attributes->position < 0) {
        document_.warnings.add(where + " has no POSITION and is not drawn");
        return std::nullopt;
    }
    const tinygltf::Accessor& position = document_.model.accessors[size_t(attributes->position)];
    if (position.minValues.empty() || position.maxValues.empty())
        document_.warnings.add(
            fmt::format("{}.POSITION (accessors[{}]) has no min and max", where, attributes->position));
    auto triangles = triangles_of(primitive, where, position.count);
    if (!triangles) return tl::unexpected(triangles.error());
    if (triangles->empty()) return std::nullopt;
    if (auto room = make_room(position.count, triangles->size(), where); !room)
        return tl::unexpected(room.error());
    const auto array = decode(*attributes);
    if (!array) return located(where, array.error());

    const bool needs_tangents = normal_map && !(*array)->has_tangents;
    uint32_t first_vertex = 0;
    if ((*array)->has_normals && !needs_tangents) {
        first_vertex = place(**array);
    } else {
        if (auto room = make_room(triangles->size(), 0, where); !room) return tl::unexpected(room.error());
        const Vertex* source =
            (*array)->first ? &scene_.vertices[*(*array)->first] : (*array)->vertices.data();
        std::vector<Vertex> vertices = gather(source, *triangles);
        if (!(*array)->has_normals) flatten(vertices, *triangles);
        if (needs_tangents) generate_tangents(vertices, *triangles, *normal_map);
        first_vertex = uint32_t(scene_.vertices.size());
        scene_.vertices.insert(scene_.vertices.end(), vertices.begin(), vertices.end());
    }
    const Primitive added{.first_index = uint32_t(scene_.indices.size()),
                          .index_count = uint32_t(triangles->size())};
    for (const uint32_t index : *triangles) scene_.indices.push_back(first_vertex + index);
    return added;
}

}  // namespace lumo::scene::gltf
