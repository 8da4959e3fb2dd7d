// What a glTF file says, as the scene that it becomes.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/unit/scene_gltf_file.hpp"

namespace lumo::scene {
namespace {

using namespace test;
using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr float pi = std::numbers::pi_v<float>;
const std::filesystem::path shared_data = LUMO_SHARED_DATA;

void expect_near(glm::vec3 actual, glm::vec3 expected, float tolerance = 1e-5f) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "component " << i;
}

glm::vec3 at(const glm::mat4& m, glm::vec3 p) { return m * glm::vec4(p, 1); }

// The corner positions of all triangles of the scene's primitives.
std::vector<glm::vec3> corners(const Scene& scene) {
    std::vector<glm::vec3> positions;
    for (const uint32_t index : scene.indices) positions.push_back(scene.vertices[index].position);
    return positions;
}

std::vector<uint32_t> drawn_indices(json primitive, GltfFile& file) {
    file.place(file.mesh({{"POSITION", file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3")},
                          {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}},
                         std::move(primitive)));
    return loaded(file.load()).indices;
}

TEST(Gltf, PrimitiveModesBecomeTriangles) {
    const auto of = [](json primitive) {
        GltfFile file;
        return drawn_indices(std::move(primitive), file);
    };
    EXPECT_THAT(of({{"mode", 4}}), ElementsAre(0, 1, 2));  // 5 vertices: two are left over
    EXPECT_THAT(of({{"mode", 5}}), ElementsAre(0, 1, 2, 1, 3, 2, 2, 3, 4));
    EXPECT_THAT(of({{"mode", 6}}), ElementsAre(1, 2, 0, 2, 3, 0, 3, 4, 0));
    GltfFile strip;
    EXPECT_THAT(drawn_indices({{"mode", 5}, {"indices", strip.indices({4, 3, 2, 1})}}, strip),
                ElementsAre(4, 3, 2, 3, 1, 2));
    GltfFile list;
    EXPECT_THAT(drawn_indices({{"indices", list.indices({2, 1, 0, 4, 3, 2})}}, list),
                ElementsAre(2, 1, 0, 4, 3, 2));
}

TEST(Gltf, IndicesMayBeOfEachUnsignedType) {
    std::string bytes, words;
    append<uint8_t>(bytes, {2, 1, 0});
    append<uint32_t>(words, {2, 1, 0});
    GltfFile small, large, none;
    EXPECT_THAT(
        drawn_indices({{"indices", small.accessor(small.view(bytes), ubyte_type, 3, "SCALAR")}}, small),
        ElementsAre(2, 1, 0));
    EXPECT_THAT(
        drawn_indices({{"indices", large.accessor(large.view(words), uint_type, 3, "SCALAR")}}, large),
        ElementsAre(2, 1, 0));
    // An accessor without a view holds zeros, also as indices.
    EXPECT_THAT(drawn_indices({{"indices", none.accessor(-1, ushort_type, 3, "SCALAR")}}, none),
                ElementsAre(0, 0, 0));
}

TEST(Gltf, PointsAndLinesAreLeftOutByName) {
    for (const int mode : {0, 1, 2, 3}) {
        GltfFile file;
        file.place(file.mesh({{"POSITION", file.triangle_positions()}}, {{"mode", mode}}));
        const Scene scene = loaded(file.load());
        EXPECT_EQ(scene.triangle_count(), 0u);
        EXPECT_THAT(scene.warnings, Contains(HasSubstr(mode == 0 ? "is of points" : "is of lines")));
    }
}

TEST(Gltf, MissingNormalsAreFlat) {
    GltfFile file;
    // A roof of two triangles with a shared edge: smooth normals would agree there.
    file.place(file.mesh({{"POSITION", file.floats({0, 0, 0, 0, 0, 1, 1, 1, 0, -1, 1, 0}, "VEC3")}},
                         {{"indices", file.indices({0, 1, 2, 1, 0, 3})}}));
    const Scene scene = loaded(file.load());
    ASSERT_THAT(scene.vertices, SizeIs(6));
    const float h = std::sqrt(0.5f);
    for (int i = 0; i < 3; ++i) expect_near(scene.vertices[scene.indices[size_t(i)]].normal, {-h, h, 0});
    for (int i = 3; i < 6; ++i) expect_near(scene.vertices[scene.indices[size_t(i)]].normal, {h, h, 0});
    EXPECT_EQ(corners(scene)[5], glm::vec3(-1, 1, 0));
}

TEST(Gltf, NormalsOfLengthZeroAreReplacedAndLongOnesNormalized) {
    GltfFile zero, longer;
    zero.place(zero.mesh({{"POSITION", zero.triangle_positions()},
                          {"NORMAL", zero.floats({1, 0, 0, 0, 0, 0, 1, 0, 0}, "VEC3")}}));
    const Scene flat = loaded(zero.load());
    for (const Vertex& v : flat.vertices) expect_near(v.normal, {0, 0, 1});
    EXPECT_THAT(flat.warnings, Contains(HasSubstr("normals of length 0")));
    longer.place(longer.mesh({{"POSITION", longer.triangle_positions()},
                              {"NORMAL", longer.floats({0, 3, 0, 0, 1, 0, 0, 1, 0}, "VEC3")}}));
    const Scene unit = loaded(longer.load());
    for (const Vertex& v : unit.vertices) expect_near(v.normal, {0, 1, 0});
    EXPECT_THAT(unit.warnings, Contains(HasSubstr("not of unit length")));
}

TEST(Gltf, VertexColoursInEachForm) {
    std::string bytes, shorts;
    append<uint8_t>(bytes, {255, 0, 51, 0, 0, 255, 0, 0, 0, 0, 255, 0});
    append<uint16_t>(shorts, {65535, 0, 13107, 32768, 0, 0, 0, 0, 0, 0, 0, 0});
    const auto first_color = [](auto make) {
        GltfFile file;
        file.place(file.mesh({{"POSITION", file.triangle_positions()},
                              {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                              {"COLOR_0", make(file)}}));
        return loaded(file.load()).vertices.at(0).color;
    };
    const json unit = {{"normalized", true}};
    EXPECT_EQ(
        first_color([&](GltfFile& f) { return f.accessor(f.view(bytes, 4), ubyte_type, 3, "VEC3", unit); }),
        glm::vec4(1, 0, 0.2f, 1));
    EXPECT_EQ(
        first_color([&](GltfFile& f) { return f.accessor(f.view(shorts), ushort_type, 3, "VEC4", unit); }),
        glm::vec4(1, 0, 0.2f, 32768 / 65535.0f));
    EXPECT_EQ(first_color([](GltfFile& f) {
                  return f.floats({0.5f, 0.25f, 1.5f, 0, 0, 0, 0, 0, 0}, "VEC3");
              }),
              glm::vec4(0.5f, 0.25f, 1, 1));
}

TEST(Gltf, QuantizedMeshesAreRead) {
    GltfFile file;
    file.document["extensionsUsed"] = file.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    std::string positions, normals, uvs;
    append<int16_t>(positions, {-3, 5, 7, 0, 100, 0, 0, 0, 0, 0, 100, 0});
    append<int8_t>(normals, {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0});
    append<uint16_t>(uvs, {2, 3, 0, 0, 0, 0});
    file.place(file.mesh(
        {{"POSITION", file.accessor(file.view(positions, 8), short_type, 3, "VEC3")},
         {"NORMAL", file.accessor(file.view(normals, 4), byte_type, 3, "VEC3", {{"normalized", true}})},
         {"TEXCOORD_0", file.accessor(file.view(uvs), ushort_type, 3, "VEC2")}}));
    const Scene scene = loaded(file.load());
    ASSERT_THAT(scene.vertices, SizeIs(3));
    EXPECT_EQ(scene.vertices[0].position, glm::vec3(-3, 5, 7));
    EXPECT_EQ(scene.vertices[0].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.vertices[0].uv0, glm::vec2(2, 3));
}

TEST(Gltf, AttributesOfWrongFormAreErrors) {
    const auto message = [](const char* attribute, auto make) {
        GltfFile file;
        json attributes = {{"POSITION", file.triangle_positions()}};
        attributes[attribute] = make(file);
        file.place(file.mesh(attributes));
        return error_of(file.load()).message;
    };
    EXPECT_THAT(message("POSITION",
                        [](GltfFile& f) {
                            return f.floats({0, 0, 1, 1, 2, 2}, "VEC2");
                        }),
                HasSubstr("POSITION"));
    EXPECT_THAT(message("NORMAL", [](GltfFile& f) { return f.accessor(-1, ubyte_type, 3, "VEC3"); }),
                HasSubstr("NORMAL"));
    EXPECT_THAT(message("COLOR_0", [](GltfFile& f) { return f.accessor(-1, ubyte_type, 3, "VEC4"); }),
                HasSubstr("COLOR_0"));
    EXPECT_THAT(message("TEXCOORD_0",
                        [](GltfFile& f) {
                            return f.floats({0, 0, 1, 1}, "VEC2");
                        }),
                HasSubstr("has 2 elements, POSITION has 3"));
}

TEST(Gltf, PrimitivesWithTheSameAttributesShareVertices) {
    GltfFile file;
    const json attributes = {{"POSITION", file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3")},
                             {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}};
    file.place(file.mesh(attributes, {{"indices", file.indices({0, 1, 2})}}));
    file.place(file.mesh(attributes, {{"indices", file.indices({1, 3, 2})}}));
    const Scene scene = loaded(file.load());
    EXPECT_THAT(scene.vertices, SizeIs(4));
    EXPECT_THAT(scene.indices, ElementsAre(0, 1, 2, 1, 3, 2));
}

TEST(Gltf, NodesMultiplyAndMatrixEqualsTrs) {
    GltfFile file;
    const int mesh = file.mesh({{"POSITION", file.triangle_positions()}});
    const float h = std::sqrt(0.5f);
    // Scale, then a quarter turn around +Z, then a translation.
    file.place(mesh, {{"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 3, 4}}});
    file.place(mesh, {{"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1}}});
    const int child = file.add("nodes", {{"mesh", mesh}, {"translation", {1, 0, 0}}});
    const int parent = file.add("nodes", {{"children", {child}}, {"scale", {10, 10, -10}}});
    file.document["scenes"][0]["nodes"].push_back(parent);
    const Scene scene = loaded(file.load());
    ASSERT_THAT(scene.instances, SizeIs(3));
    EXPECT_THAT(scene.meshes, SizeIs(1));
    for (int i = 0; i < 2; ++i) {
        const glm::mat4& m = scene.instances[size_t(i)].world_from_object;
        expect_near(at(m, {1, 0, 0}), {1, 4, 3});
        expect_near(at(m, {0, 1, 0}), {-2, 2, 3});
        expect_near(at(m, {0, 0, 1}), {1, 2, 7});
    }
    expect_near(at(scene.instances[2].world_from_object, {0, 0, 1}), {10, 0, -10});
    EXPECT_EQ(scene.triangle_count(), 3u);
}

TEST(Gltf, SingularTransformsAreLeftOutByName) {
    GltfFile file;
    const int mesh = file.mesh({{"POSITION", file.triangle_positions()}});
    file.place(mesh, {{"scale", {1, 0, 1}}, {"name", "flat"}});
    file.place(mesh, {{"scale", {1e-6, 1e-6, 1e-6}}});  // small is not singular
    const Scene scene = loaded(file.load());
    EXPECT_THAT(scene.instances, SizeIs(1));
    EXPECT_THAT(scene.warnings,
                Contains(HasSubstr("nodes[0] ('flat') has a transform that cannot be inverted")));
}

TEST(Gltf, TheDefaultSceneIsDrawn) {
    GltfFile file;
    const int mesh = file.mesh({{"POSITION", file.triangle_positions()}});
    for (const float x : {1.0f, 2.0f, 3.0f}) file.add("nodes", {{"mesh", mesh}, {"translation", {x, 0, 0}}});
    const auto drawn = [&] {
        std::vector<float> xs;
        for (const Instance& i : loaded(file.load()).instances) xs.push_back(i.world_from_object[3].x);
        return xs;
    };
    EXPECT_THAT(drawn(), ElementsAre(1, 2, 3));  // no scene at all
    file.document["scenes"] = {{{"nodes", {2}}}, {{"nodes", {1, 0}}}};
    EXPECT_THAT(drawn(), ElementsAre(3));
    file.document["scene"] = 1;
    EXPECT_THAT(drawn(), ElementsAre(2, 1));
    EXPECT_THAT(loaded(file.load()).warnings, Contains(HasSubstr("only scenes[1]")));
}

TEST(Gltf, CamerasStandWhereTheirNodesAre) {
    GltfFile file;
    file.document["cameras"] = {
        {{"type", "perspective"},
         {"name", "front"},
         {"perspective", {{"yfov", 0.8}, {"znear", 0.1}, {"zfar", 50}}}},
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.5}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"zfar", 9}, {"znear", 0}}}}};
    const float h = std::sqrt(0.5f);
    file.add("nodes",
             {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}, {"scale", {2, 2, 2}}});
    file.add("nodes", {{"camera", 1}, {"name", "far"}, {"translation", {0, 0, 5000}}});
    file.add("nodes", {{"camera", 2}});
    file.place(file.mesh({{"POSITION", file.triangle_positions()}}));
    file.document["scenes"][0]["nodes"] = {2, 1, 0, 3};  // the cameras keep the file's order all the same
    const Scene scene = loaded(file.load());
    ASSERT_THAT(scene.cameras, SizeIs(3));
    const Camera& front = scene.cameras[0];
    EXPECT_EQ(front.name, "front");
    EXPECT_EQ(front.position, glm::vec3(1, 2, 3));
    expect_near(glm::normalize(front.target - front.position), {-1, 0, 0});  // -Z, turned around +Y
    expect_near(front.up, {0, 1, 0});
    EXPECT_FLOAT_EQ(front.vertical_fov, 0.8f);
    EXPECT_FLOAT_EQ(front.near_plane, 0.1f);
    EXPECT_FLOAT_EQ(front.far_plane, 50);
    EXPECT_FALSE(front.orthographic_height);
    EXPECT_EQ(scene.cameras[1].name, "far");
    EXPECT_TRUE(std::isfinite(scene.cameras[1].far_plane));
    EXPECT_GT(scene.cameras[1].far_plane, 5001);  // an endless camera still reaches everything
    EXPECT_EQ(scene.cameras[2].orthographic_height, 6.0f);
    EXPECT_FLOAT_EQ(scene.cameras[2].far_plane, 9);
    EXPECT_EQ(default_camera(scene).name, "front");
}

TEST(Gltf, FaultyCamerasAreLeftOutByName) {
    GltfFile file;
    file.document["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 2}, {"zfar", 1}}}}};
    file.add("nodes", {{"camera", 0}});
    const Scene scene = loaded(file.load());
    EXPECT_THAT(scene.cameras, IsEmpty());
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("cameras[0] has zfar 1 and znear 2")));
}

TEST(Gltf, TheDefaultCameraSeesAllBounds) {
    GltfFile file;
    file.place(file.mesh({{"POSITION", file.floats({-5, 0, 2, 40, 1, 0, 0, 9, -70}, "VEC3")}}));
    const Scene scene = loaded(file.load());
    const Bounds bounds = world_bounds(scene);
    EXPECT_EQ(bounds.min, glm::vec3(-5, 0, -70));
    EXPECT_EQ(bounds.max, glm::vec3(40, 9, 2));
    const Camera camera = default_camera(scene);
    const glm::vec3 axis = glm::normalize(camera.target - camera.position);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                          corner & 4 ? bounds.max.z : bounds.min.z);
        const float depth = glm::dot(p - camera.position, axis);
        EXPECT_GT(depth, camera.near_plane);
        EXPECT_LT(depth, camera.far_plane);
        EXPECT_LT(std::acos(depth / glm::length(p - camera.position)), camera.vertical_fov / 2);
    }
}

TEST(Gltf, BoundsFollowTurnedInstances) {
    GltfFile file;
    const int mesh = file.mesh({{"POSITION", file.triangle_positions()}});
    const float angle = pi / 4;
    file.place(mesh, {{"rotation", {0, 0, std::sin(angle / 2), std::cos(angle / 2)}}});
    const Bounds bounds = world_bounds(loaded(file.load()));
    const float h = std::sqrt(0.5f);
    expect_near(bounds.min, {-h, 0, 0});
    expect_near(bounds.max, {h, h, 0});  // a turned box would reach to twice that
}

TEST(Gltf, PunctualLights) {
    GltfFile file;
    file.document["extensionsUsed"] = {"KHR_lights_punctual"};
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"color", {1, 0.5, 0.25}}, {"intensity", 4}, {"name", "sun"}},
        {{"type", "point"}, {"intensity", 683}, {"range", 7}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}}};
    const auto light = [](int index) { return json{{"KHR_lights_punctual", {{"light", index}}}}; };
    const float h = std::sqrt(0.5f);
    file.add("nodes", {{"extensions", light(0)}, {"rotation", {-h, 0, 0, h}}, {"scale", {3, 3, 3}}});
    file.add("nodes", {{"extensions", light(1)}, {"translation", {1, 2, 3}}});
    file.add("nodes", {{"extensions", light(2)}});
    const Scene scene = loaded(file.load());
    ASSERT_THAT(scene.lights, SizeIs(3));
    const Light& sun = scene.lights[0];
    EXPECT_EQ(sun.kind, LightKind::directional);
    EXPECT_EQ(sun.name, "sun");
    EXPECT_EQ(sun.intensity, glm::vec3(4, 2, 1));
    expect_near(sun.direction, {0, -1, 0});
    EXPECT_EQ(scene.lights[1].kind, LightKind::point);
    EXPECT_EQ(scene.lights[1].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights[1].range, 7);
    EXPECT_EQ(scene.lights[1].intensity, glm::vec3(683));
    EXPECT_EQ(scene.lights[2].kind, LightKind::spot);
    EXPECT_FLOAT_EQ(scene.lights[2].inner_cone_angle, 0.2f);
    EXPECT_FLOAT_EQ(scene.lights[2].outer_cone_angle, 0.4f);

    const Scene photometric = loaded(file.load({}, {.photometric = true}));
    expect_near(photometric.lights[1].intensity, glm::vec3(1));
}

// A file with one triangle of the material, whose textures[0] is a pixel image.
GltfFile file_with(json material) {
    GltfFile file;
    file.document["materials"] = {std::move(material)};
    const std::string png = make_png(1, 1, 8, 2, "abc");
    const int view = file.view(png);
    file.document["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    file.document["textures"] = {{{"source", 0}}};
    file.place(file.mesh({{"POSITION", file.triangle_positions()},
                          {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                          {"TEXCOORD_0", file.floats({0, 0, 1, 0, 0, 1}, "VEC2")},
                          {"TEXCOORD_1", file.floats({5, 5, 6, 5, 5, 6}, "VEC2")}},
                         {{"material", 0}}));
    return file;
}

TEST(Gltf, MaterialsWithEveryMember) {
    const json transform = {
        {"KHR_texture_transform", {{"offset", {0.5, -1}}, {"scale", {2, 3}}, {"texCoord", 1}}}};
    GltfFile file = file_with({
        {"name", "all"},
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
          {"metallicFactor", 0.5},
          {"roughnessFactor", 0.25},
          {"baseColorTexture", {{"index", 0}}},
          {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}},
        {"normalTexture", {{"index", 0}, {"scale", 0.75}, {"extensions", transform}}},
        {"occlusionTexture", {{"index", 0}, {"strength", 0.125}}},
        {"emissiveTexture", {{"index", 0}}},
        {"emissiveFactor", {1, 0.5, 0}},
        {"alphaMode", "MASK"},
        {"alphaCutoff", 0.375},
        {"doubleSided", true},
        {"extensions",
         {{"KHR_materials_unlit", json::object()},
          {"KHR_materials_emissive_strength", {{"emissiveStrength", 1366}}}}},
    });
    file.document["extensionsUsed"] = {"KHR_materials_unlit", "KHR_materials_emissive_strength",
                                       "KHR_texture_transform"};
    const Scene scene = loaded(file.load());
    EXPECT_THAT(scene.warnings, IsEmpty());
    ASSERT_THAT(scene.materials, SizeIs(1));
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.name, "all");
    EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.emission, glm::vec3(1366, 683, 0));
    EXPECT_EQ(m.normal_scale, 0.75f);
    EXPECT_EQ(m.occlusion_strength, 0.125f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.375f);
    EXPECT_TRUE(m.double_sided);
    EXPECT_TRUE(m.unlit);
    for (const auto* slot : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                             &m.occlusion_texture, &m.emission_texture}) {
        ASSERT_TRUE(*slot);
        EXPECT_EQ((*slot)->texture, 0u);
    }
    EXPECT_EQ(m.base_color_texture->uv_set, 0u);
    EXPECT_EQ(m.metallic_roughness_texture->uv_set, 1u);
    EXPECT_EQ(m.normal_texture->uv_set, 1u);  // the transform's texCoord wins
    EXPECT_EQ(glm::vec2(m.normal_texture->uv_transform * glm::vec3(1, 1, 1)), glm::vec2(2.5f, 2));
    EXPECT_THAT(scene.textures, SizeIs(1));
    ASSERT_THAT(scene.images, SizeIs(1));
    EXPECT_THAT(scene.images[0].values, ElementsAre('a', 'b', 'c', 255));
    const Scene photometric = loaded(file.load({}, {.photometric = true}));
    expect_near(photometric.materials[0].emission, {2, 1, 0});
}

TEST(Gltf, MaterialDefaultsAreTheSpecifications) {
    for (const bool given : {true, false}) {
        GltfFile file = file_with(json::object());
        if (!given) file.document["meshes"][0]["primitives"][0].erase("material");
        const Scene scene = loaded(file.load());
        ASSERT_THAT(scene.materials, SizeIs(1));
        const Material& m = scene.materials[0];
        EXPECT_EQ(m.base_color, glm::vec4(1));
        EXPECT_EQ(m.metallic, 1);
        EXPECT_EQ(m.roughness, 1);
        EXPECT_FALSE(m.emits());
        EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
        EXPECT_EQ(m.alpha_cutoff, 0.5f);
        EXPECT_FALSE(m.double_sided || m.unlit || m.base_color_texture || m.normal_texture);
        // Nothing that is drawn has the image.
        EXPECT_THAT(scene.images, IsEmpty());
        EXPECT_THAT(scene.warnings, Contains(HasSubstr("1 images are of no material that is drawn")));
    }
}

TEST(Gltf, EverySamplerSetting) {
    const auto sampler_of = [](json sampler) {
        GltfFile file = file_with({{"emissiveTexture", {{"index", 0}}}});
        file.document["samplers"] = {std::move(sampler)};
        file.document["textures"][0]["sampler"] = 0;
        return loaded(file.load()).textures.at(0).sampler;
    };
    using enum Filter;
    EXPECT_EQ(sampler_of(json::object()), TextureSampler{});
    const auto filters = [&](int mag, int min) {
        return sampler_of({{"magFilter", mag}, {"minFilter", min}});
    };
    EXPECT_EQ(filters(9728, 9728),
              (TextureSampler{.magnification = nearest, .minification = nearest, .mip = {}}));
    EXPECT_EQ(filters(9729, 9729), (TextureSampler{.mip = {}}));
    EXPECT_EQ(filters(9729, 9984), (TextureSampler{.minification = nearest, .mip = nearest}));
    EXPECT_EQ(filters(9729, 9985), (TextureSampler{.minification = linear, .mip = nearest}));
    EXPECT_EQ(filters(9729, 9986), (TextureSampler{.minification = nearest, .mip = linear}));
    EXPECT_EQ(filters(9729, 9987), (TextureSampler{.minification = linear, .mip = linear}));
    EXPECT_EQ(sampler_of({{"wrapS", 33071}, {"wrapT", 33648}}),
              (TextureSampler{.wrap_u = Wrap::clamp_to_edge, .wrap_v = Wrap::mirrored_repeat}));
    EXPECT_EQ(sampler_of({{"wrapS", 10497}}).wrap_u, Wrap::repeat);
}

TEST(Gltf, TextureCoordinatesBeyondTheSecondSetAreSaid) {
    const Scene third = loaded(file_with({{"emissiveTexture", {{"index", 0}, {"texCoord", 2}}}}).load());
    EXPECT_FALSE(third.materials.at(0).emission_texture);
    EXPECT_THAT(third.warnings, Contains(HasSubstr("reads TEXCOORD_2")));
    GltfFile lacking = file_with({{"emissiveTexture", {{"index", 0}, {"texCoord", 1}}}});
    lacking.document["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_1");
    EXPECT_THAT(loaded(lacking.load()).warnings, Contains(HasSubstr("has no TEXCOORD_1")));
}

TEST(Gltf, TangentsAreMadeOnlyForNormalMaps) {
    GltfFile with = file_with({{"normalTexture", {{"index", 0}}}});
    for (const Vertex& v : loaded(with.load()).vertices) {
        expect_near(glm::vec3(v.tangent), {1, 0, 0});
        EXPECT_EQ(v.tangent.w, -1);  // v runs up in space, but down in the image
    }
    GltfFile own = file_with({{"normalTexture", {{"index", 0}}}});
    own.document["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
        own.floats({0, 2, 0, 1, 0, 1, 0, 1, 0, 1, 0, -1}, "VEC4");
    const Scene kept = loaded(own.load());
    ASSERT_THAT(kept.vertices, SizeIs(3));
    EXPECT_EQ(kept.vertices[0].tangent, glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(kept.vertices[2].tangent, glm::vec4(0, 1, 0, -1));
}

TEST(Gltf, ExtensionsRequiredAreErrorsAndUsedAreWarnings) {
    GltfFile used;
    used.document["extensionsUsed"] = {"EXT_novelty", "KHR_materials_unlit"};
    EXPECT_THAT(loaded(used.load()).warnings, Contains(HasSubstr("extension EXT_novelty is used")));
    EXPECT_THAT(loaded(used.load()).warnings, Not(Contains(HasSubstr("unlit"))));
    GltfFile required;
    required.document["extensionsUsed"] =
        required.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    const Error error = error_of(required.load());
    EXPECT_EQ(error.kind, ErrorKind::unsupported);
    EXPECT_THAT(error.message, HasSubstr("KHR_draco_mesh_compression"));
}

TEST(Gltf, AnimatedSkinnedAndMorphedStandAtRest) {
    GltfFile file;
    file.document["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
    file.document["skins"] = {{{"joints", {0}}}};
    const int target = file.floats({9, 9, 9, 9, 9, 9, 9, 9, 9}, "VEC3");
    file.place(file.mesh({{"POSITION", file.triangle_positions()}}, {{"targets", {{{"POSITION", target}}}}}),
               {{"skin", 0}, {"weights", {1}}});
    const Scene scene = loaded(file.load());
    EXPECT_EQ(world_bounds(scene).max, glm::vec3(1, 1, 0));
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("animations are not played")));
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("nodes[0] is skinned")));
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("morph targets are not drawn")));
}

TEST(Gltf, GlbIsTheSameAsGltf) {
    GltfFile file = file_with({{"emissiveTexture", {{"index", 0}}}});
    const TemporaryFolder folder;
    const Scene glb = loaded(load_gltf(folder.write("a.glb", file.glb())));
    // The content decides as well, whatever the file is called.
    const Scene renamed = loaded(load_gltf(folder.write("b.gltf", file.glb())));
    const Scene gltf = loaded(load_gltf(file.write(folder)));
    EXPECT_EQ(corners(glb), corners(gltf));
    EXPECT_EQ(corners(renamed), corners(gltf));
    EXPECT_EQ(glb.images.at(0).values, gltf.images.at(0).values);
}

TEST(Gltf, DataUrisHoldBuffersAndImages) {
    GltfFile file;
    file.add("bufferViews", {{"buffer", 0}, {"byteLength", 36}});
    file.document["buffers"] = {
        {{"byteLength", 36},
         {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
    file.place(file.mesh({{"POSITION", file.accessor(0, float_type, 3, "VEC3")}}));
    const TemporaryFolder folder;
    const Scene scene = loaded(load_gltf(folder.write("a.gltf", file.document.dump())));
    EXPECT_EQ(corners(scene), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

// --- The shared files ---

Scene shared_scene(const char* file) { return loaded(load_gltf(shared_data / file)); }

#define SKIP_WITHOUT_SHARED_DATA() \
    if (!std::filesystem::exists(shared_data)) GTEST_SKIP() << "needs the shared test data"

TEST(GltfShared, Sponza) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("sponza/Sponza.gltf");
    EXPECT_EQ(scene.triangle_count(), 262'267u);
    EXPECT_EQ(scene.vertices.size(), 192'647u);
    EXPECT_THAT(scene.materials, SizeIs(25));
    EXPECT_THAT(scene.meshes.at(0).primitives, SizeIs(25));
    EXPECT_THAT(scene.images, SizeIs(69));
    EXPECT_THAT(scene.warnings, IsEmpty());
    const Bounds bounds = world_bounds(scene);
    expect_near(bounds.min, {-15.37f, -1.01f, -9.46f}, 0.005f);
    expect_near(bounds.max, {14.40f, 11.44f, 8.84f}, 0.005f);
    EXPECT_EQ(std::ranges::count(scene.materials, AlphaMode::mask, &Material::alpha_mode), 3);
    EXPECT_EQ(std::ranges::count(scene.materials, true, &Material::double_sided), 3);
    for (const Material& m : scene.materials) EXPECT_NEAR(m.base_color.x, 0.588f, 1e-3f) << m.name;
    for (const Image8& image : scene.images) EXPECT_LE(std::max(image.width, image.height), 512u);
    const auto mirrored =
        std::ranges::count_if(scene.vertices, [](const Vertex& v) { return v.tangent.w < 0; });
    EXPECT_NEAR(double(mirrored) / double(scene.vertices.size()), 0.42, 0.01);
}

TEST(GltfShared, BoxTextured) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/BoxTextured/BoxTextured.gltf");
    EXPECT_EQ(scene.triangle_count(), 12u);
    EXPECT_TRUE(scene.materials.at(0).base_color_texture);
    EXPECT_EQ(scene.materials[0].metallic, 0);
    EXPECT_EQ(world_bounds(scene).max, glm::vec3(0.5f));
    // Each face's normal points out of the box, also in the world.
    for (size_t i = 0; i < scene.indices.size(); i += 3) {
        const auto vertex = [&](size_t k) { return scene.vertices[scene.indices[i + k]]; };
        const glm::vec3 face =
            glm::cross(vertex(1).position - vertex(0).position, vertex(2).position - vertex(0).position);
        EXPECT_GT(glm::dot(face, vertex(0).normal), 0);
        EXPECT_GT(glm::dot(vertex(0).position, vertex(0).normal), 0);
    }
}

TEST(GltfShared, EmissiveStrength) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/EmissiveStrengthTest.glb");
    for (const auto& [name, strength] :
         {std::pair{"Emit1", 1.0f}, {"Emit2", 2.0f}, {"Emit4", 4.0f}, {"Emit8", 8.0f}, {"Emit16", 16.0f}}) {
        const auto material = std::ranges::find(scene.materials, name, &Material::name);
        ASSERT_NE(material, scene.materials.end()) << name;
        expect_near(material->emission, strength * glm::vec3(0.1f, 0.5f, 0.9f));
    }
}

TEST(GltfShared, AlphaModes) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/AlphaBlendModeTest.glb");
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_GE(std::ranges::count(scene.materials, AlphaMode::mask, &Material::alpha_mode), 3);
    EXPECT_EQ(std::ranges::count(scene.materials, AlphaMode::blend, &Material::alpha_mode), 1);
    std::vector<float> cutoffs;
    for (const Material& m : scene.materials)
        if (m.alpha_mode == AlphaMode::mask) cutoffs.push_back(m.alpha_cutoff);
    EXPECT_THAT(cutoffs, testing::IsSupersetOf({0.25f, 0.5f, 0.75f}));
}

// The file's markers stand where the tip of the arrow must come to lie, so they tell what the transform has to be.
TEST(GltfShared, TextureTransformPutsTheArrowOnItsMark) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/TextureTransformTest/TextureTransformTest.gltf");
    // The tip in the image, where the untransformed quad's "not supported" mark is.
    const glm::vec2 tip(0.5f + 0.2778f, 0.5f + 0.2778f);
    const auto image_of = [&](const char* material, glm::vec2 mark) {
        const auto found = std::ranges::find(scene.materials, material, &Material::name);
        const glm::vec2 uv(0.5f + mark.x, 0.5f - mark.y);  // quads of size 1, v downwards
        return glm::vec2(found->base_color_texture->uv_transform * glm::vec3(uv, 1));
    };
    EXPECT_LT(glm::distance(image_of("Rotation", {-0.07905f, -0.51627f}), tip), 1e-3f);
    EXPECT_LT(glm::distance(image_of("Scale", {0.018545f, -0.018545f}), tip), 1e-3f);
    EXPECT_LT(glm::distance(image_of("All", {-0.07f, -0.25f}), tip), 0.04f);  // a mark placed by hand
    const auto offset = std::ranges::find(scene.materials, "Offset UV", &Material::name);
    EXPECT_EQ(glm::vec2(offset->base_color_texture->uv_transform * glm::vec3(0, 0, 1)), glm::vec2(0.5f));
}

TEST(GltfShared, MetalRoughGrid) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/own/metal_rough_grid.gltf");
    EXPECT_THAT(scene.instances, SizeIs(21));
    std::vector<float> roughness;
    for (const Material& m : scene.materials) roughness.push_back(m.roughness);
    EXPECT_EQ(*std::ranges::min_element(roughness), 0);
    EXPECT_EQ(*std::ranges::max_element(roughness), 1);
    EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(GltfShared, NormalMapHemisphere) {
    SKIP_WITHOUT_SHARED_DATA();
    const Scene scene = shared_scene("gltf/own/normal_map_hemisphere.gltf");
    EXPECT_EQ(scene.triangle_count(), 1646u);
    EXPECT_TRUE(scene.materials.at(0).normal_texture);
    for (uint32_t k = 0; k < scene.meshes[0].primitives[0].index_count; ++k)
        EXPECT_EQ(scene.vertices[scene.indices[k]].tangent, glm::vec4(1, 0, 0, 1));
}

}  // namespace
}  // namespace lumo::scene
