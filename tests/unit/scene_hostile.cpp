// Files that mean harm, or are only broken: whatever they hold, loading ends soon, in a scene or in an error that
// names what is wrong, and takes no more memory than the file bears out.
#include <chrono>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <sys/stat.h>

#include "scene/gltf_bytes.hpp"
#include "scene/printable.hpp"
#include "tests/unit/scene_gltf_file.hpp"

namespace lumo::scene {
namespace {

using namespace test;
using nlohmann::json;
using testing::AnyOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

namespace fs = std::filesystem;

TEST(Printable, KeepsTextAndDropsWhatATerminalObeys) {
    EXPECT_EQ(printable("Säule №3 — 柱"), "Säule №3 — 柱");
    EXPECT_EQ(printable("a\x1b[31mb\nc\td\x7f"), "a?[31mb?c?d?");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m"),
              "?31m");  // C1 control sequence introducer
    EXPECT_EQ(printable("\xe2\x80\xae"
                        "gpj.exe"),
              "?gpj.exe");                                           // right-to-left override
    EXPECT_EQ(printable("a\xff\xc0\xaf\xed\xa0\x80z"), "a??????z");  // not UTF-8, overlong, a surrogate
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a?b");
    EXPECT_EQ(printable("abcdef", 3), "abc…");
    EXPECT_EQ(printable("aé", 2), "a…");
}

// --- Paths ---

// A folder with inside/scene.gltf, whose one buffer is at the URI, and secret.bin outside of inside/.
struct UriCase {
    TemporaryFolder folder;

    UriCase() {
        folder.write("secret.bin", std::string(36, 's'));
        folder.write("inside/data.bin", std::string(36, '\0'));
        folder.write("inside/a b%.bin", std::string(36, '\0'));
        folder.write("inside/sub/data.bin", std::string(36, '\0'));
    }

    Result<Scene> load(const std::string& uri) {
        GltfFile file;
        file.document["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
        return load_gltf(folder.write("inside/scene.gltf", file.document.dump()));
    }
};

TEST(HostileUri, InsideTheFolderIsRead) {
    UriCase c;
    for (const char* uri :
         {"data.bin", "./data.bin", "sub/data.bin", "sub/../data.bin", "a%20b%25.bin", "%64ata.bin"}) {
        const auto scene = c.load(uri);
        EXPECT_TRUE(scene) << uri << ": " << to_string(scene.error());
    }
    fs::create_symlink("sub/data.bin", c.folder.path() / "inside/link.bin");
    EXPECT_TRUE(c.load("link.bin"));
}

TEST(HostileUri, OutsideOfItIsNot) {
    UriCase c;
    fs::create_symlink("../secret.bin", c.folder.path() / "inside/link.bin");
    fs::create_directory_symlink("..", c.folder.path() / "inside/up");
    for (const std::string& uri :
         {std::string("../secret.bin"), std::string("..%2fsecret.bin"), std::string("%2e%2e/secret.bin"),
          std::string("sub/../../secret.bin"), (c.folder.path() / "secret.bin").string(),
          std::string("/etc/passwd"), std::string("link.bin"), std::string("up/secret.bin"),
          std::string("../inside-not/x.bin")}) {
        const Error error = error_of(c.load(uri));
        EXPECT_EQ(error.kind, ErrorKind::invalid_file) << uri;
        EXPECT_THAT(error.message, HasSubstr("leads out of the glTF's folder")) << uri;
        EXPECT_THAT(error.message, HasSubstr("buffers[0].uri")) << uri;
        EXPECT_THAT(error.subject, HasSubstr("scene.gltf")) << uri;
    }
    // Whether a file exists outside makes no difference to what is said.
    EXPECT_EQ(error_of(c.load("../secret.bin")).remedy, error_of(c.load("../nothing.bin")).remedy);
}

TEST(HostileUri, OnlyRegularFilesAreOpened) {
    UriCase c;
    const fs::path pipe = c.folder.path() / "inside/pipe.bin";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const char* uri : {"pipe.bin", "sub", "."})
        EXPECT_THAT(error_of(c.load(uri)).message, HasSubstr("is not a regular file")) << uri;
    EXPECT_EQ(error_of(load_gltf(pipe)).kind, ErrorKind::io);
    EXPECT_EQ(error_of(load_gltf(c.folder.path())).kind, ErrorKind::io);
    EXPECT_EQ(error_of(load_gltf(c.folder.path() / "none.gltf")).kind, ErrorKind::io);
}

TEST(HostileUri, FaultsAreNamed) {
    UriCase c;
    EXPECT_EQ(error_of(c.load("http://example.com/a.bin")).kind, ErrorKind::unsupported);
    EXPECT_EQ(error_of(c.load("file:///etc/passwd")).kind, ErrorKind::unsupported);
    EXPECT_THAT(error_of(c.load("a%2")).message, HasSubstr("two hexadecimal digits"));
    EXPECT_THAT(error_of(c.load("a%zz.bin")).message, HasSubstr("two hexadecimal digits"));
    EXPECT_THAT(error_of(c.load("data.bin%00.png")).message, HasSubstr("is not the name of a file"));
    EXPECT_THAT(error_of(c.load("")).message, HasSubstr("is not the name of a file"));
    EXPECT_EQ(error_of(c.load("none.bin")).kind, ErrorKind::io);
    EXPECT_EQ(error_of(c.load(std::string(5000, 'x'))).kind, ErrorKind::io);
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64,AA*A")).message,
                HasSubstr("not base64"));
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64,AAA")).message,
                HasSubstr("multiple of 4"));
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64,A=AA")).message,
                HasSubstr("not base64"));
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64,====")).message,
                HasSubstr("not base64"));
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64")).message, HasSubstr("comma"));
    EXPECT_THAT(error_of(c.load("data:application/octet-stream;base64,AAAA")).message,
                HasSubstr("has 3 bytes"));
}

TEST(HostileUri, Base64) {
    const auto text = [](std::string_view encoded) {
        const auto bytes = gltf::base64_decoded(encoded);
        return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "error";
    };
    EXPECT_EQ(text(""), "");
    EXPECT_EQ(text("bHVtbw=="), "lumo");
    EXPECT_EQ(text("bHVtb3M="), "lumos");
    EXPECT_EQ(text("bHVtb3Mh"), "lumos!");
    EXPECT_EQ(text("+/+/"), "\xfb\xff\xbf");
}

// --- Sizes ---

TEST(HostileSize, WhatTheFileDoesNotHoldIsNotAllocated) {
    GltfFile buffer;
    buffer.document["buffers"] = {
        {{"byteLength", 9007199254740992}, {"uri", "data:application/octet-stream;base64,AAAA"}}};
    EXPECT_THAT(error_of(buffer.load()).message, HasSubstr("byteLength is 9007199254740992"));

    GltfFile zeros;
    zeros.place(zeros.mesh({{"POSITION", zeros.accessor(-1, float_type, 4'000'000'000, "VEC3")}}));
    EXPECT_EQ(error_of(zeros.load()).kind, ErrorKind::limit);

    // Many small ones add up.
    GltfFile many;
    for (int i = 0; i < 20; ++i) many.accessor(-1, float_type, 100'000, "VEC3");
    EXPECT_EQ(error_of(many.load()).kind, ErrorKind::limit);

    GltfFile indices;
    indices.place(indices.mesh({{"POSITION", indices.triangle_positions()}},
                               {{"indices", indices.accessor(-1, uint_type, 4'000'000'000, "SCALAR")}}));
    EXPECT_EQ(error_of(indices.load()).kind, ErrorKind::limit);
}

TEST(HostileSize, VerticesAndIndicesAreCountedOverTheWholeScene) {
    GltfFile file;
    for (int i = 0; i < 3; ++i) file.place(file.mesh({{"POSITION", file.triangle_positions()}}));
    EXPECT_TRUE(file.load({.max_vertices = 18}));
    EXPECT_THAT(error_of(file.load({.max_vertices = 8})).message,
                HasSubstr("vertices beyond the limit of 8"));
    EXPECT_THAT(error_of(file.load({.max_indices = 8})).message, HasSubstr("indices beyond the limit of 8"));
    EXPECT_THAT(error_of(file.load({.max_instances = 2})).message, HasSubstr("limit of 2"));
    EXPECT_THAT(error_of(file.load({.max_nodes = 2})).message, HasSubstr("nodes has 3 entries"));
    EXPECT_THAT(error_of(file.load({.max_objects = 2})).message, HasSubstr("beyond the limit of 2"));
    EXPECT_THAT(error_of(file.load({.max_json_bytes = 100})).message, HasSubstr("limit of 100"));
    EXPECT_THAT(error_of(file.load({.max_buffer_bytes = 100})).message, HasSubstr("limit of 100"));
}

TEST(HostileSize, JsonMayNotBeOfVeryManyValues) {
    const TemporaryFolder folder;
    std::string text = R"({"asset":{"version":"2.0"},"extras":[)";
    for (int i = 0; i < 1000; ++i) text += i % 2 ? "{}," : "[],";
    const auto file = folder.write("many.gltf", text + "0]}");
    EXPECT_TRUE(load_gltf(file));
    EXPECT_THAT(error_of(load_gltf(file, {.max_json_values = 1000})).message,
                HasSubstr("beyond the limit of 1000"));
}

TEST(HostileSize, ImagesAreCountedTogether) {
    GltfFile file;
    const std::string png = make_png(8, 8, 8, 2, std::string(192, 'x'));
    for (int i = 0; i < 3; ++i) {
        file.add("images", {{"bufferView", file.view(png)}, {"mimeType", "image/png"}});
        file.add("textures", {{"source", i}});
    }
    file.document["materials"] = {{{"emissiveTexture", {{"index", 0}}},
                                   {"normalTexture", {{"index", 1}}},
                                   {"occlusionTexture", {{"index", 2}}}}};
    file.place(file.mesh({{"POSITION", file.triangle_positions()}}, {{"material", 0}}));
    EXPECT_TRUE(file.load({.images = {.max_bytes = 3 * 256}}));
    const Error error = error_of(file.load({.images = {.max_bytes = 3 * 256 - 1}}));
    EXPECT_EQ(error.kind, ErrorKind::limit);
    EXPECT_THAT(error.message, HasSubstr("images["));
    EXPECT_EQ(error_of(file.load({.images = {.max_side = 7}})).kind, ErrorKind::limit);
}

TEST(HostileSize, JsonMayNotBeDeep) {
    const TemporaryFolder folder;
    const auto nested = [&](const std::string& before, const std::string& open, const std::string& close,
                            int depth) {
        std::string text = before;
        for (int i = 0; i < depth; ++i) text += open;
        text += "0";
        for (int i = 0; i < depth; ++i) text += close;
        return load_gltf(folder.write("deep.gltf", text + (before.empty() ? "" : "}")));
    };
    EXPECT_EQ(error_of(nested("", "[", "]", 2'000'000)).kind, ErrorKind::limit);
    EXPECT_EQ(error_of(nested("", "{\"a\":", "}", 500'000)).kind, ErrorKind::limit);
    // Not even where nothing is read.
    EXPECT_EQ(error_of(nested(R"({"asset":{"version":"2.0"},"extras":)", "[", "]", 500'000)).kind,
              ErrorKind::limit);
    EXPECT_TRUE(nested(R"({"asset":{"version":"2.0"},"extras":)", "[", "]", 20));
    EXPECT_EQ(error_of(load_gltf(folder.write("cut.gltf", std::string(2'000'000, '[')))).kind,
              ErrorKind::limit);
    EXPECT_TRUE(
        load_gltf(folder.write("text.gltf", R"({"asset":{"version":"2.0","generator":"[[\"[[[{{{"}})"),
                  {.max_json_depth = 2}));
}

// --- Nodes ---

GltfFile chain(int depth) {
    GltfFile file;
    for (int i = 0; i < depth; ++i)
        file.add("nodes", i + 1 < depth ? json{{"children", {i + 1}}} : json{{"name", "last"}});
    file.document["scenes"] = {{{"nodes", {0}}}};
    return file;
}

TEST(HostileNodes, DepthIsLimited) {
    EXPECT_TRUE(chain(1024).load());
    const Error error = error_of(chain(1025).load());
    EXPECT_EQ(error.kind, ErrorKind::limit);
    EXPECT_THAT(error.message, HasSubstr("nodes[1024] ('last') is deeper than the limit of 1024"));
    EXPECT_EQ(error_of(chain(900'000).load()).kind, ErrorKind::limit);
}

TEST(HostileNodes, LoopsAndSecondParentsAreErrors) {
    const auto error = [](json nodes, json roots) {
        GltfFile file;
        file.document["nodes"] = std::move(nodes);
        file.document["scenes"] = {{{"nodes", std::move(roots)}}};
        return error_of(file.load()).message;
    };
    const json leaf = json::object();
    const auto to = [](std::initializer_list<int> children) { return json{{"children", children}}; };
    EXPECT_THAT(error({to({0})}, {0}), HasSubstr("nodes[0] is its own ancestor"));
    EXPECT_THAT(error({to({1}), to({2}), to({0})}, {0}), HasSubstr("is its own ancestor"));
    EXPECT_THAT(error({leaf, to({2}), to({1})}, {0}),
                HasSubstr("is its own ancestor"));  // not even in the scene
    EXPECT_THAT(error({to({2}), to({2}), leaf}, {0, 1}),
                HasSubstr("nodes[2] is a child of nodes[0] and of nodes[1]"));
    EXPECT_THAT(error({to({1, 1}), leaf}, {0}), HasSubstr("nodes[1] is a child of nodes[0] and of nodes[0]"));
    EXPECT_THAT(error({to({1}), leaf}, {1}), HasSubstr("which is a child of nodes[0]"));
}

TEST(HostileNodes, TransformsThatAreNotFiniteAreErrors) {
    GltfFile file;
    file.document["nodes"] = {{{"scale", {1e30, 1e30, 1e30}}, {"children", {1}}},
                              {{"scale", {1e30, 1e30, 1e30}}}};
    EXPECT_THAT(error_of(file.load()).message, HasSubstr("nodes[1] has a transform that is not finite"));
    file.document["nodes"] = {{{"rotation", {0, 0, 0, 0}}}};
    EXPECT_THAT(error_of(file.load()).message, HasSubstr("rotation of length 0"));
    file.document["nodes"] = {{{"matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}};
    EXPECT_THAT(error_of(file.load()).message, HasSubstr("last row"));
}

// --- Text ---

TEST(HostileText, NothingShownControlsATerminal) {
    const std::string evil = "\x1b]0;owned\x07\nname";
    GltfFile file;
    file.document["extensionsUsed"] = {evil};
    file.document["materials"] = {{{"name", evil}, {evil, 1}, {"alphaCutoff", -1}}};
    file.place(file.mesh({{"POSITION", file.triangle_positions()}, {evil, 0}}, {{"material", 0}}),
               {{"name", evil}, {"rotation", {0, 0, 0, 3}}});
    file.document["meshes"][0]["name"] = evil;
    const Scene scene = loaded(file.load());
    EXPECT_GE(scene.warnings.size(), 5u);
    EXPECT_THAT(scene.warnings, Each(Not(AnyOf(HasSubstr("\x1b"), HasSubstr("\x07"), HasSubstr("\n")))));
    EXPECT_EQ(scene.materials.at(0).name, "?]0;owned??name");
    EXPECT_EQ(scene.meshes.at(0).name, "?]0;owned??name");

    file.document["nodes"][0]["matrix"] = evil;
    const Error error = error_of(file.load());
    EXPECT_THAT(error.message, Not(HasSubstr("\x1b")));
    const TemporaryFolder folder;
    EXPECT_THAT(error_of(load_gltf(folder.write("a\x1b[2J.gltf", "{"))).subject, Not(HasSubstr("\x1b")));
}

TEST(HostileText, WarningsAreBounded) {
    GltfFile file;
    json& asset = file.document["asset"];
    for (int i = 0; i < 5000; ++i) asset["unknown" + std::to_string(i)] = i;
    const Scene scene = loaded(file.load());
    EXPECT_THAT(scene.warnings, SizeIs(65));
    EXPECT_THAT(scene.warnings.back(), HasSubstr("warnings more"));
}

// --- Broken in every place ---

// A file that uses everything the loader reads.
GltfFile everything() {
    GltfFile file;
    file.document["extensionsUsed"] = {"KHR_texture_transform", "KHR_lights_punctual", "KHR_materials_unlit",
                                       "KHR_materials_emissive_strength"};
    const std::string png = make_png(2, 2, 8, 2, "abcdefghijkl");
    file.document["images"] = {{{"bufferView", file.view(png)}, {"mimeType", "image/png"}, {"name", "i"}}};
    file.document["samplers"] = {
        {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 10497}}};
    file.document["textures"] = {{{"source", 0}, {"sampler", 0}}};
    const json info = {{"index", 0},
                       {"texCoord", 0},
                       {"extensions",
                        {{"KHR_texture_transform",
                          {{"offset", {0.5, 0}}, {"rotation", 1}, {"scale", {2, 2}}, {"texCoord", 1}}}}}};
    file.document["materials"] = {
        {{"name", "m"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {1, 1, 1, 1}}, {"baseColorTexture", info}, {"metallicFactor", 1}}},
         {"normalTexture", info},
         {"emissiveFactor", {1, 1, 1}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.5},
         {"doubleSided", true},
         {"extensions",
          {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}},
           {"KHR_materials_unlit", json::object()}}}}};
    std::string sparse_index;
    append<uint16_t>(sparse_index, {1});
    std::string value;
    append<float>(value, {1, 0});
    const json sparse = {
        {"count", 1},
        {"indices",
         {{"bufferView", file.view(sparse_index)}, {"byteOffset", 0}, {"componentType", ushort_type}}},
        {"values", {{"bufferView", file.view(value)}, {"byteOffset", 0}}}};
    const int interleaved = file.view(std::string(80, '\0'), 20);
    file.place(file.mesh({{"POSITION", file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3")},
                          {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                          {"TEXCOORD_0", file.accessor(-1, float_type, 4, "VEC2", {{"sparse", sparse}})},
                          {"TEXCOORD_1", file.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2")},
                          {"COLOR_0", file.accessor(interleaved, ubyte_type, 4, "VEC4",
                                                    {{"normalized", true}, {"byteOffset", 12}})}},
                         {{"indices", file.indices({0, 1, 2, 1, 3, 2})}, {"material", 0}, {"mode", 4}}),
               {{"name", "n"}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, 1, 1}}, {"translation", {0, 0, 0}}});
    file.document["cameras"] = {
        {{"type", "perspective"},
         {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"zfar", 10}, {"aspectRatio", 1}}}}};
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"},
                                                                     {"color", {1, 1, 1}},
                                                                     {"intensity", 1},
                                                                     {"range", 3},
                                                                     {"spot", {{"innerConeAngle", 0.1}}}}};
    file.add("nodes", {{"camera", 0},
                       {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                       {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    file.document["nodes"][0]["children"] = {1};
    file.document["scene"] = 0;
    return file;
}

// What a scene says of itself must hold together whatever it was made from.
void expect_whole(const Scene& scene, const std::string& what) {
    for (const uint32_t index : scene.indices) ASSERT_LT(index, scene.vertices.size()) << what;
    for (const Instance& instance : scene.instances) ASSERT_LT(instance.mesh, scene.meshes.size()) << what;
    for (const Texture& texture : scene.textures) ASSERT_LT(texture.image, scene.images.size()) << what;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives) {
            ASSERT_LE(uint64_t(p.first_index) + p.index_count, scene.indices.size()) << what;
            ASSERT_EQ(p.index_count % 3, 0u) << what;
            ASSERT_LT(p.material, scene.materials.size()) << what;
        }
    for (const Material& m : scene.materials)
        for (const auto* slot : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                 &m.occlusion_texture, &m.emission_texture})
            if (*slot) {
                ASSERT_LT((*slot)->texture, scene.textures.size()) << what;
            }
    for (const Vertex& v : scene.vertices) {
        ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z)) << what;
        ASSERT_NEAR(glm::length(v.normal), 1, 1e-3f) << what;
        ASSERT_NEAR(glm::length(glm::vec3(v.tangent)), 1, 1e-3f) << what;
        ASSERT_EQ(std::abs(v.tangent.w), 1) << what;
    }
    for (const Image8& image : scene.images)
        ASSERT_EQ(image.values.size(), size_t(image.width) * image.height * 4) << what;
}

void expect_ends_well(const Result<Scene>& scene, const std::string& what) {
    if (scene) {
        expect_whole(*scene, what);
        return;
    }
    EXPECT_FALSE(scene.error().subject.empty()) << what;
    EXPECT_FALSE(scene.error().message.empty()) << what;
}

TEST(HostileFuzz, TheFileToBreakIsSound) {
    const Scene scene = loaded(everything().load());
    expect_whole(scene, "");
    EXPECT_EQ(scene.triangle_count(), 2u);
    EXPECT_THAT(scene.cameras, SizeIs(1));
    EXPECT_THAT(scene.lights, SizeIs(1));
}

TEST(HostileFuzz, EveryValueReplacedByEveryKindOfNonsense) {
    GltfFile file = everything();
    const TemporaryFolder folder;
    file.write(folder);  // sets the buffers
    const auto without = [](json document, const json::json_pointer& where) {
        json& parent = document[where.parent_pointer()];
        if (parent.is_array())
            parent.erase(std::stoul(where.back()));
        else
            parent.erase(where.back());
        return document;
    };
    const std::vector<json> nonsense = {nullptr,
                                        true,
                                        -1,
                                        0,
                                        1,
                                        2,
                                        255,
                                        65536,
                                        2147483647,
                                        4294967295,
                                        9007199254740992,
                                        1e300,
                                        0.5,
                                        -0.0,
                                        "",
                                        "x",
                                        "..",
                                        json::array(),
                                        json::object(),
                                        {0, 0},
                                        {-1},
                                        {{"bufferView", 0}}};
    // Every leaf, and every object and array around one.
    std::set<std::string> places;
    const json leaves = file.document.flatten();
    for (const auto& leaf : leaves.items())
        for (json::json_pointer where(leaf.key()); !where.empty(); where = where.parent_pointer())
            places.insert(where.to_string());
    size_t loads = 0, errors = 0;
    for (const std::string& place : places) {
        const json::json_pointer where(place);
        for (const json& value : nonsense) {
            json broken = file.document;
            broken[where] = value;
            const auto scene = load_gltf(folder.write("broken.gltf", broken.dump()));
            expect_ends_well(scene, place + " = " + value.dump());
            ++loads;
            errors += !scene;
        }
        expect_ends_well(load_gltf(folder.write("broken.gltf", without(file.document, where).dump())),
                         place + " erased");
    }
    EXPECT_GT(loads, 1000u);
    EXPECT_GT(errors, loads / 3);
}

TEST(HostileFuzz, GlbsCutAndFlipped) {
    const std::string whole = everything().glb();
    const TemporaryFolder folder;
    ASSERT_TRUE(load_gltf(folder.write("whole.glb", whole)));
    for (size_t size = 0; size < whole.size(); size += size < 64 ? 1 : 37) {
        const auto cut = load_gltf(folder.write("cut.glb", whole.substr(0, size)));
        EXPECT_FALSE(cut) << size;
    }
    std::minstd_rand random(1);
    for (int i = 0; i < 1500; ++i) {
        std::string flipped = whole;
        for (int k = 0; k < 3; ++k) {
            // The header, the JSON and the data by turns, which are of very different length.
            const size_t range = k == 0 ? 28 : flipped.size();
            flipped[random() % range] = i % 2 ? char(random()) : char(flipped[random() % range] ^ 1);
        }
        expect_ends_well(load_gltf(folder.write("flipped.glb", flipped)), "flip " + std::to_string(i));
    }
}

// --- Other people's broken files ---

const fs::path invalid_files = fs::path(LUMO_SHARED_DATA) / "gltf-invalid";

struct Outcome {
    Result<Scene> scene;
    std::string text;  // the error or all warnings
};

Outcome outcome_of(const fs::path& file) {
    Outcome outcome{.scene = load_gltf(file), .text = {}};
    if (!outcome.scene) outcome.text = to_string(outcome.scene.error());
    if (outcome.scene)
        for (const std::string& warning : outcome.scene->warnings) outcome.text += warning + "\n";
    return outcome;
}

// How lumo's messages call what the validator's JSON pointer points to: "/meshes/0/…" is meshes[0], or meshes.
std::vector<std::string> names_of(const std::string& pointer) {
    if (pointer.empty()) return {};
    const size_t slash = pointer.find('/', 1);
    const std::string name = pointer.substr(1, slash - 1);
    if (pointer.find("/targets") != pointer.npos) return {"morph targets"};
    if (pointer.find("weights") != pointer.npos) return {"morph targets", "nodes"};
    if (name.starts_with("extensions")) return {"extension"};
    if (slash == pointer.npos) return {name};
    const std::string index = pointer.substr(slash + 1, pointer.find('/', slash + 1) - slash - 1);
    if (index.find_first_not_of("0123456789") == index.npos) return {name + "[" + index + "]", name + " "};
    return {index};
}

TEST(HostileCorpus, EveryFileEndsSoonInASceneOrAnError) {
    if (!fs::exists(invalid_files)) GTEST_SKIP() << "needs the shared test data";
    size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(invalid_files)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".gltf" && extension != ".glb") continue;
        ++count;
        const auto start = std::chrono::steady_clock::now();
        const Outcome outcome = outcome_of(entry.path());
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        expect_ends_well(outcome.scene, entry.path().string());
        EXPECT_LT(seconds.count(), 5) << entry.path();
    }
    EXPECT_GE(count, 280u);
}

// The validator's reports say what is wrong with each of its files; lumo has to say something about the same object.
TEST(HostileCorpus, WhatTheValidatorFindsIsNamed) {
    if (!fs::exists(invalid_files)) GTEST_SKIP() << "needs the shared test data";
    const fs::path root = invalid_files / "khronos-validator";
    size_t with_errors = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path report_file = entry.path().string() + ".report.json";
        if (!fs::exists(report_file)) continue;
        const std::string name = fs::relative(entry.path(), root).string();
        std::ifstream stream(report_file);
        const json report = json::parse(stream);
        const Outcome outcome = outcome_of(entry.path());
        std::vector<std::string> codes, names;
        for (const json& message : report["issues"]["messages"]) {
            if (message["severity"] != 0) continue;
            codes.push_back(message["code"]);
            for (const std::string& n : names_of(message.value("pointer", ""))) names.push_back(n);
            // The validator blames the attribute for what is in its accessor.
            if (codes.back().starts_with("ACCESSOR_")) names.emplace_back("accessors[");
        }
        if (codes.empty()) continue;
        ++with_errors;
        // The container or the JSON itself.
        if (names.empty() || outcome.text.find("is not valid JSON") != std::string::npos)
            names = {"GLB", "JSON", "the document", "asset"};
        const bool named = std::ranges::any_of(
            names, [&](const std::string& n) { return outcome.text.find(n) != std::string::npos; });
        EXPECT_TRUE(named) << name << " (" << testing::PrintToString(codes) << ", "
                           << testing::PrintToString(names) << ") says: " << outcome.text;
    }
    EXPECT_EQ(with_errors, 190u);
}

// And where the validator finds no error, lumo loads the file, apart from these.
TEST(HostileCorpus, WhatTheValidatorAcceptsLoads) {
    if (!fs::exists(invalid_files)) GTEST_SKIP() << "needs the shared test data";
    const fs::path root = invalid_files / "khronos-validator";
    const std::map<std::string, std::string> refused = {
        {"accessor/unknown_type.gltf", "type is 'NotaVEC3'"},                 // the validator only warns
        {"asset/min_version_valid.gltf", "asset.minVersion is '2.1'"},        // lumo reads 2.0
        {"buffer/non_relative_uri.gltf", "'http://example.com/buffer.bin'"},  // lumo reads files
        {"root/named_objects.gltf", "buffers[0], which has no data"},         // and draws what has some
        {"root/unused_objects.gltf", "buffers[0], which has no data"},
    };
    size_t without_errors = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path report_file = entry.path().string() + ".report.json";
        if (!fs::exists(report_file)) continue;
        std::ifstream stream(report_file);
        if (json::parse(stream)["issues"]["numErrors"] != 0) continue;
        ++without_errors;
        const std::string name = fs::relative(entry.path(), root).string();
        const Outcome outcome = outcome_of(entry.path());
        const auto reason = refused.find(name);
        EXPECT_EQ(outcome.scene.has_value(), reason == refused.end()) << name << ": " << outcome.text;
        if (reason != refused.end()) {
            EXPECT_THAT(outcome.text, HasSubstr(reason->second)) << name;
        }
    }
    EXPECT_EQ(without_errors, 73u);
}

TEST(HostileCorpus, OtherLoadersFiles) {
    if (!fs::exists(invalid_files)) GTEST_SKIP() << "needs the shared test data";
    const std::pair<const char*, const char*> errors[] = {
        {"assimp/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "accessors[2] has -inf in element 0"},
        {"assimp/IncorrectVertexArrays/Cube.gltf", "bufferViews[2] has 432 bytes from 504"},
        {"assimp/IndexOutOfRange/AllIndicesOutOfRange.gltf", "has index 65535 at 0 of accessors[0]"},
        {"assimp/IndexOutOfRange/IndexOutOfRange.gltf", "has index 255 at 0 of accessors[0]"},
        {"assimp/MissingBin/BoxTextured.gltf", "buffers[0].uri 'BoxTextured0.bin' cannot be found"},
        {"assimp/RecursiveNodes/RecursiveNodes.gltf", "nodes[0] is its own ancestor"},
        {"assimp/SchemaFailures/sceneWrongType.gltf", "scene is the string 'hello'"},
        {"assimp/TestNoRootNode/NoScene.gltf", "scene is 0, but there are 0 in scenes"},
        {"assimp/wrongTypes/badArray.gltf", "meshes[0].primitives is an object, not an array"},
        {"assimp/wrongTypes/badExtension.gltf", "KHR_texture_transform is the string"},
        {"assimp/wrongTypes/badNumber.gltf", "materials[0].normalTexture lacks 'index'"},
        {"assimp/wrongTypes/badObject.gltf", "pbrMetallicRoughness is an array, not an object"},
        {"assimp/wrongTypes/badString.gltf", "scenes[0].name is 42, not a string"},
        {"assimp/wrongTypes/badUint.gltf", "baseColorTexture.index is -1"},
        {"tinygltf/BoundsChecking/integer-out-of-bounds.gltf", "byteLength is 1e+300"},
        {"tinygltf/BoundsChecking/invalid-buffer-index.gltf", "bufferViews[1].buffer is 1"},
        {"tinygltf/BoundsChecking/invalid-buffer-view-index.gltf", "accessors[0].bufferView is 1"},
        {"tinygltf/BoundsChecking/invalid-primitive-indices.gltf", "accessors[0].bufferView is 1"},
        {"tinygltf/issue-416.gltf", "asset.version is ''"},
    };
    for (const auto& [file, message] : errors) {
        const Outcome outcome = outcome_of(invalid_files / file);
        EXPECT_FALSE(outcome.scene) << file;
        EXPECT_THAT(outcome.text, HasSubstr(message)) << file;
    }
    const std::tuple<const char*, const char*, uint64_t> scenes[] = {
        {"assimp/BoxBadNormals-glTF-Binary/BoxBadNormals.glb", "normals of length 0", 12},
        {"assimp/TestNoRootNode/SceneWithoutNodes.gltf", "nothing to draw", 0},
        {"assimp/issue_3269/texcoord_crash.gltf", "has no TEXCOORD_0", 10},
        {"tinygltf/issue-492.glb", "nothing to draw", 0},
        {"tinygltf/regression/unassigned-skeleton.gltf", "skinned", 8},
        {"tinygltf/regression/zero-sized-bin-chunk-issue-440.glb", "", 1},
    };
    for (const auto& [file, warning, triangles] : scenes) {
        const Outcome outcome = outcome_of(invalid_files / file);
        ASSERT_TRUE(outcome.scene) << file << ": " << outcome.text;
        EXPECT_THAT(outcome.text, HasSubstr(warning)) << file;
        EXPECT_EQ(outcome.scene->triangle_count(), triangles) << file;
    }
}

}  // namespace
}  // namespace lumo::scene
