// A small glTF file put together by a test.
#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "scene/gltf.hpp"
#include "tests/unit/scene_files.hpp"

namespace lumo::scene::test {

inline constexpr int byte_type = 5120, ubyte_type = 5121, short_type = 5122, ushort_type = 5123,
                     uint_type = 5125, float_type = 5126;

struct GltfFile {
    nlohmann::json document = {{"asset", {{"version", "2.0"}}}};
    std::string data;

    /// Appends bytes, aligned to 4, as a buffer view; its index.
    int view(std::string_view bytes, int stride = 0) {
        data.resize((data.size() + 3) / 4 * 4);
        nlohmann::json entry = {{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}};
        if (stride > 0) entry["byteStride"] = stride;
        data += bytes;
        return add("bufferViews", entry);
    }

    int add(const char* array, nlohmann::json entry) {
        document[array].push_back(std::move(entry));
        return int(document[array].size()) - 1;
    }

    int accessor(int view, int component_type, size_t count, const char* type,
                 const nlohmann::json& more = nlohmann::json::object()) {
        nlohmann::json entry = {{"componentType", component_type}, {"count", count}, {"type", type}};
        if (view >= 0) entry["bufferView"] = view;
        entry.update(more);
        return add("accessors", entry);
    }

    int floats(std::initializer_list<float> values, const char* type) {
        const size_t components = std::string_view(type) == "SCALAR" ? 1 : size_t(type[3] - '0');
        std::string bytes;
        append<float>(bytes, values);
        return accessor(view(bytes), float_type, values.size() / components, type);
    }

    int indices(std::initializer_list<uint16_t> values) {
        std::string bytes;
        append<uint16_t>(bytes, values);
        return accessor(view(bytes), ushort_type, values.size(), "SCALAR");
    }

    /// A triangle in the plane z = 0, facing +Z: (0,0), (1,0), (0,1).
    int triangle_positions() {
        const int accessor = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        document["accessors"][size_t(accessor)].update({{"min", {0, 0, 0}}, {"max", {1, 1, 0}}});
        return accessor;
    }

    int mesh(nlohmann::json attributes, const nlohmann::json& more = nlohmann::json::object()) {
        nlohmann::json primitive = {{"attributes", std::move(attributes)}};
        primitive.update(more);
        return add("meshes", {{"primitives", {primitive}}});
    }

    /// A root node that draws a mesh.
    int place(int mesh, const nlohmann::json& more = nlohmann::json::object()) {
        nlohmann::json node = {{"mesh", mesh}};
        node.update(more);
        const int index = add("nodes", node);
        if (!document.contains("scenes")) document["scenes"] = {{{"nodes", nlohmann::json::array()}}};
        document["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    std::filesystem::path write(const TemporaryFolder& folder, const std::string& name = "test") {
        if (!data.empty()) {
            folder.write(name + ".bin", data);
            document["buffers"] = {{{"byteLength", data.size()}, {"uri", name + ".bin"}}};
        }
        return folder.write(name + ".gltf", document.dump());
    }

    std::string glb() {
        if (!data.empty()) document["buffers"] = {{{"byteLength", data.size()}}};
        std::string json = document.dump(), binary = data;
        json.resize((json.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4);
        std::string file = "glTF";
        append<uint32_t>(file,
                         {2, uint32_t(28 + json.size() + binary.size()), uint32_t(json.size()), 0x4e4f534a});
        file += json;
        append<uint32_t>(file, {uint32_t(binary.size()), 0x004e4942});
        return file + binary;
    }

    Result<Scene> load(const Limits& limits = {}, const GltfOptions& options = {}) {
        const TemporaryFolder folder;
        return load_gltf(write(folder), limits, options);
    }
};

/// The scene, or an empty one and a failure that says why.
inline Scene loaded(Result<Scene> scene) {
    EXPECT_TRUE(scene) << to_string(scene.error());
    return scene ? std::move(*scene) : Scene{};
}

/// The error that loading must end in.
inline Error error_of(const Result<Scene>& scene) {
    EXPECT_FALSE(scene);
    return scene ? Error{} : scene.error();
}

}  // namespace lumo::scene::test
