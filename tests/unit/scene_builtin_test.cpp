#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "scene/builtin/builtin.hpp"

namespace lumo::scene {
namespace {

Scene make(std::string_view name) {
    Result<Scene> scene = make_builtin(name);
    EXPECT_TRUE(scene.has_value()) << name;
    return scene ? std::move(*scene) : Scene{};
}

struct Triangle {
    std::array<Vertex, 3> corners;  // as stored
    std::string where;

    glm::vec3 edge(size_t i) const { return corners[i].position - corners[0].position; }
    glm::vec3 doubled_area() const { return glm::cross(edge(1), edge(2)); }
};

std::vector<Triangle> triangles_of(const Scene& scene, const Mesh& mesh) {
    std::vector<Triangle> result;
    for (const Primitive& primitive : mesh.primitives) {
        for (uint32_t i = 0; i < primitive.index_count; i += 3) {
            Triangle triangle{.corners = {},
                              .where = mesh.name + "/" + scene.materials[primitive.material].name};
            for (uint32_t k = 0; k < 3; ++k) {
                triangle.corners[k] = scene.vertices[scene.indices[primitive.first_index + i + k]];
            }
            result.push_back(triangle);
        }
    }
    return result;
}

const Mesh& mesh_named(const Scene& scene, std::string_view name) {
    const auto found = std::ranges::find(scene.meshes, name, &Mesh::name);
    EXPECT_NE(found, scene.meshes.end()) << name;
    return *found;
}

/// How many triangles have each edge, by the bits of its positions; opposite directions cancel in a closed
/// surface.
bool is_closed(const Scene& scene, const Mesh& mesh) {
    using Point = std::array<float, 3>;
    std::map<std::pair<Point, Point>, int> edges;
    const auto key = [](glm::vec3 p) { return Point{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; };
    for (const Triangle& triangle : triangles_of(scene, mesh)) {
        for (size_t i = 0; i < 3; ++i) {
            const Point a = key(triangle.corners[i].position),
                        b = key(triangle.corners[(i + 1) % 3].position);
            ++edges[{a, b}];
            --edges[{b, a}];
        }
    }
    return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

TEST(Builtin, UnknownNameIsAnErrorThatListsTheKnown) {
    const Result<Scene> scene = make_builtin("cornel");
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().kind, ErrorKind::invalid_argument);
    EXPECT_EQ(scene.error().subject, "cornel");
    EXPECT_THAT(scene.error().remedy,
                testing::AllOf(testing::HasSubstr("atrium"), testing::HasSubstr("furnace")));
}

class EachBuiltin : public testing::TestWithParam<std::string_view> {
  protected:
    const Scene scene_ = make(GetParam());
};

TEST_P(EachBuiltin, CarriesItsName) { EXPECT_EQ(scene_.name, GetParam()); }

TEST_P(EachBuiltin, IndicesAreInRange) {
    EXPECT_FALSE(scene_.instances.empty());
    for (const Instance& instance : scene_.instances) {
        EXPECT_LT(instance.mesh, scene_.meshes.size());
        EXPECT_GT(std::abs(glm::determinant(glm::mat3(instance.world_from_object))), 0.5f);
    }
    for (const Mesh& mesh : scene_.meshes) {
        EXPECT_FALSE(mesh.primitives.empty()) << mesh.name;
        for (const Primitive& primitive : mesh.primitives) {
            EXPECT_LT(primitive.material, scene_.materials.size());
            EXPECT_GT(primitive.index_count, 0u) << mesh.name;
            EXPECT_EQ(primitive.index_count % 3, 0u);
            EXPECT_LE(size_t(primitive.first_index) + primitive.index_count, scene_.indices.size());
        }
    }
    for (const uint32_t index : scene_.indices) ASSERT_LT(index, scene_.vertices.size());
    for (const Texture& texture : scene_.textures) EXPECT_LT(texture.image, scene_.images.size());
    for (const Material& material : scene_.materials) {
        for (const auto& slot :
             {material.base_color_texture, material.metallic_roughness_texture, material.normal_texture,
              material.occlusion_texture, material.emission_texture}) {
            if (slot) {
                EXPECT_LT(slot->texture, scene_.textures.size()) << material.name;
            }
        }
    }
    for (const Image8& image : scene_.images) {
        EXPECT_EQ(image.values.size(), size_t(image.width) * image.height * image.channels);
    }
}

TEST_P(EachBuiltin, EveryPartIsUsed) {
    std::set<uint32_t> meshes, materials, textures, images;
    for (const Instance& instance : scene_.instances) meshes.insert(instance.mesh);
    for (const Mesh& mesh : scene_.meshes) {
        for (const Primitive& primitive : mesh.primitives) materials.insert(primitive.material);
    }
    for (const uint32_t index : materials) {
        const Material& material = scene_.materials[index];
        for (const auto& slot :
             {material.base_color_texture, material.metallic_roughness_texture, material.normal_texture}) {
            if (slot) textures.insert(slot->texture);
        }
    }
    for (const uint32_t index : textures) images.insert(scene_.textures[index].image);
    EXPECT_EQ(meshes.size(), scene_.meshes.size());
    EXPECT_EQ(materials.size(), scene_.materials.size());
    EXPECT_EQ(textures.size(), scene_.textures.size());
    EXPECT_EQ(images.size(), scene_.images.size());
}

TEST_P(EachBuiltin, VerticesAreFiniteWithUnitFrames) {
    for (const Vertex& vertex : scene_.vertices) {
        const glm::vec3 tangent(vertex.tangent);
        for (const float value :
             {vertex.position.x, vertex.position.y, vertex.position.z, vertex.uv0.x, vertex.uv0.y}) {
            ASSERT_TRUE(std::isfinite(value));
        }
        ASSERT_NEAR(glm::length(vertex.normal), 1, 1e-4f) << vertex.position.x << " " << vertex.position.y;
        ASSERT_NEAR(glm::length(tangent), 1, 1e-4f) << vertex.position.x << " " << vertex.position.y;
        ASSERT_NEAR(glm::dot(vertex.normal, tangent), 0, 1e-3f);
        ASSERT_EQ(std::abs(vertex.tangent.w), 1);
        ASSERT_TRUE(glm::all(glm::greaterThanEqual(vertex.color, glm::vec4(0))));
    }
}

TEST_P(EachBuiltin, TrianglesHaveAreaAndFaceTheirNormals) {
    for (const Mesh& mesh : scene_.meshes) {
        for (const Triangle& triangle : triangles_of(scene_, mesh)) {
            const glm::vec3 area = triangle.doubled_area();
            const glm::vec3 at = triangle.corners[0].position;
            ASSERT_GT(glm::length(area), 5e-8f) << triangle.where;
            for (const Vertex& corner : triangle.corners) {
                ASSERT_GT(glm::dot(glm::normalize(area), corner.normal), 0.1f)
                    << triangle.where << " at " << at.x << " " << at.y << " " << at.z;
            }
        }
    }
}

TEST_P(EachBuiltin, TextureCoordinatesFollowTangentsAndDoNotMirror) {
    for (const Mesh& mesh : scene_.meshes) {
        for (const Triangle& triangle : triangles_of(scene_, mesh)) {
            const glm::vec2 a = triangle.corners[1].uv0 - triangle.corners[0].uv0;
            const glm::vec2 b = triangle.corners[2].uv0 - triangle.corners[0].uv0;
            const float determinant = a.x * b.y - a.y * b.x;
            ASSERT_NE(determinant, 0) << triangle.where;
            // Directions in which u and, by glTF's rule, -v grow.
            const glm::vec3 along_u = (b.y * triangle.edge(1) - a.y * triangle.edge(2)) / determinant;
            const glm::vec3 against_v = (b.x * triangle.edge(1) - a.x * triangle.edge(2)) / determinant;
            for (const Vertex& corner : triangle.corners) {
                const glm::vec3 tangent(corner.tangent);
                const glm::vec3 bitangent = corner.tangent.w * glm::cross(corner.normal, tangent);
                ASSERT_GT(glm::dot(along_u, tangent), 0) << triangle.where;
                ASSERT_GT(glm::dot(against_v, bitangent), 0) << triangle.where;
            }
        }
    }
}

TEST_P(EachBuiltin, IsTheSameOnEveryMake) {
    const Scene again = make(GetParam());
    ASSERT_EQ(scene_.vertices.size(), again.vertices.size());
    const bool same =
        std::ranges::equal(scene_.vertices, again.vertices, [](const Vertex& a, const Vertex& b) {
            return std::tie(a.position, a.normal, a.tangent, a.uv0, a.color) ==
                   std::tie(b.position, b.normal, b.tangent, b.uv0, b.color);
        });
    EXPECT_TRUE(same);
    EXPECT_EQ(scene_.indices, again.indices);
    ASSERT_EQ(scene_.images.size(), again.images.size());
    for (size_t i = 0; i < scene_.images.size(); ++i)
        EXPECT_EQ(scene_.images[i].values, again.images[i].values);
}

TEST_P(EachBuiltin, EveryCameraSeesTheScene) {
    ASSERT_FALSE(scene_.cameras.empty());
    const Bounds bounds = world_bounds(scene_);
    const glm::vec3 center = 0.5f * (bounds.min + bounds.max);
    const float reach = glm::distance(bounds.min, bounds.max);
    std::set<std::string> names;
    for (const Camera& camera : scene_.cameras) {
        EXPECT_TRUE(names.insert(camera.name).second) << camera.name;
        EXPECT_GT(glm::distance(camera.position, camera.target), 0.1f);
        // From high up one looks past what stands on the ground, at the sky.
        if (!scene_.sky || camera.position.y < 100) {
            EXPECT_GT(glm::dot(glm::normalize(camera.target - camera.position),
                               glm::normalize(center - camera.position)),
                      0.5f)
                << camera.name;
        }
        EXPECT_GT(camera.far_plane, glm::distance(camera.position, center) + 0.5f * reach) << camera.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EachBuiltin,
                         testing::ValuesIn(builtin_names().begin(), builtin_names().end()),
                         [](const auto& info) {
                             std::string name(info.param);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST(Cornell, HasThePublishedMeasures) {
    const Scene scene = make("cornell");
    EXPECT_EQ(scene.triangle_count(),
              38u);  // 5 walls of which the ceiling frames the lamp, and 2 blocks of 5 faces
    const Bounds bounds = world_bounds(scene);
    EXPECT_NEAR(bounds.max.x - bounds.min.x, 5.56f, 1e-5f);
    EXPECT_NEAR(bounds.max.y - bounds.min.y, 5.488f, 1e-5f);
    EXPECT_NEAR(bounds.max.z - bounds.min.z, 5.592f, 1e-5f);

    Bounds lamp;
    for (const Triangle& triangle : triangles_of(scene, mesh_named(scene, "room"))) {
        if (!triangle.where.ends_with("/lamp")) continue;
        for (const Vertex& corner : triangle.corners) {
            lamp.add(corner.position);
            EXPECT_NEAR(corner.normal.y, -1, 1e-6f);
        }
    }
    EXPECT_NEAR(lamp.max.x - lamp.min.x, 1.30f, 1e-5f);
    EXPECT_NEAR(lamp.max.z - lamp.min.z, 1.05f, 1e-5f);
    EXPECT_NEAR(lamp.min.y, 5.488f, 1e-5f);

    Bounds tall;
    for (const Triangle& triangle : triangles_of(scene, mesh_named(scene, "tall block"))) {
        for (const Vertex& corner : triangle.corners) tall.add(corner.position);
    }
    EXPECT_NEAR(tall.max.y, 3.30f, 1e-5f);
    EXPECT_NEAR(glm::degrees(scene.cameras[0].vertical_fov), 39.3f, 0.05f);
}

TEST(Cornell, LampFillsTheCeilingExactly) {
    const Scene scene = make("cornell");
    double area = 0;
    for (const Triangle& triangle : triangles_of(scene, mesh_named(scene, "room"))) {
        const bool ceiling =
            std::ranges::all_of(triangle.corners, [](const Vertex& v) { return v.position.y == 5.488f; });
        if (ceiling) area += 0.5 * double(glm::length(triangle.doubled_area()));
    }
    EXPECT_NEAR(area, 5.56 * 5.592, 1e-4);
}

TEST(Cornell, IsLitByTheLampAlone) {
    const Scene scene = make("cornell");
    EXPECT_TRUE(scene.lights.empty());
    EXPECT_EQ(scene.environment_radiance, glm::vec3(0));
    EXPECT_EQ(std::ranges::count_if(scene.materials, &Material::emits), 1);
}

TEST(AreaLight, EmitsBlueAloneBeyondEightBits) {
    for (const char* name : {"area-light", "area-light-pure"}) {
        const Scene scene = make(name);
        const auto emitter = std::ranges::find_if(scene.materials, &Material::emits);
        ASSERT_NE(emitter, scene.materials.end());
        EXPECT_EQ(emitter->emission, glm::vec3(0, 0, 10));
        EXPECT_TRUE(scene.lights.empty());
        EXPECT_TRUE(is_closed(scene, mesh_named(scene, "sphere")));
    }
}

TEST(AreaLight, WallsReflectEveryChannelAndPureOnesNone) {
    const auto albedo = [](const Scene& scene, std::string_view name) {
        return glm::vec3(std::ranges::find(scene.materials, name, &Material::name)->base_color);
    };
    const Scene scene = make("area-light"), pure = make("area-light-pure");
    for (const char* wall : {"red", "green"}) {
        EXPECT_TRUE(glm::all(glm::greaterThan(albedo(scene, wall), glm::vec3(0.05f)))) << wall;
        EXPECT_EQ(albedo(pure, wall) * glm::vec3(0, 0, 10), glm::vec3(0)) << wall;
    }
    EXPECT_EQ(albedo(pure, "red"), glm::vec3(1, 0, 0));
    EXPECT_EQ(albedo(pure, "green"), glm::vec3(0, 1, 0));
}

TEST(Furnace, BodyIsClosedConvexAndWhite) {
    const Scene scene = make("furnace");
    EXPECT_EQ(scene.environment_radiance, glm::vec3(1));
    EXPECT_TRUE(scene.lights.empty());
    for (const Material& material : scene.materials) {
        EXPECT_EQ(material.base_color, glm::vec4(1));
        EXPECT_EQ(material.metallic, 0);
        EXPECT_FALSE(material.emits());
    }
    const Mesh& body = mesh_named(scene, "body");
    EXPECT_TRUE(is_closed(scene, body));
    for (const Triangle& triangle : triangles_of(scene, body)) {
        const glm::vec3 normal = glm::normalize(triangle.doubled_area());
        // Nothing of the body stands before any of its faces, and shading normals are the faces' own.
        for (const Vertex& vertex : scene.vertices) {
            ASSERT_LT(glm::dot(normal, vertex.position - triangle.corners[0].position), 1e-5f);
        }
        for (const Vertex& corner : triangle.corners) ASSERT_GT(glm::dot(corner.normal, normal), 1 - 1e-6f);
    }
}

class Atrium : public testing::Test {
  protected:
    const Scene scene_ = make("atrium");
};

TEST_F(Atrium, IsOfTheStatedSize) {
    EXPECT_GT(scene_.triangle_count(), 80'000u);
    EXPECT_LT(scene_.triangle_count(), 130'000u);
    EXPECT_LT(scene_.instances.size(), 500u);
    const Bounds bounds = world_bounds(scene_);
    const glm::vec3 size = bounds.max - bounds.min;
    EXPECT_GT(size.x, 30);
    EXPECT_LT(size.x, 38);
    EXPECT_GT(size.y, 11);
    EXPECT_LT(size.y, 15);
    EXPECT_GT(size.z, 19);
    EXPECT_LT(size.z, 27);
}

TEST_F(Atrium, NeedsNoAlphaAndNoEmission) {
    for (const Material& material : scene_.materials) {
        EXPECT_EQ(material.alpha_mode, AlphaMode::opaque) << material.name;
        EXPECT_FALSE(material.emits()) << material.name;
        EXPECT_FALSE(material.unlit) << material.name;
    }
}

TEST_F(Atrium, AlbedosArePhysical) {
    for (const Material& material : scene_.materials) {
        EXPECT_TRUE(glm::all(glm::lessThanEqual(material.base_color, glm::vec4(1)))) << material.name;
        EXPECT_TRUE(glm::all(glm::greaterThan(material.base_color, glm::vec4(0.01f)))) << material.name;
    }
}

TEST_F(Atrium, SunReachesTheCourtOverTheRoofs) {
    ASSERT_EQ(scene_.lights.size(), 1u);
    const Light& sun = scene_.lights[0];
    EXPECT_EQ(sun.kind, LightKind::directional);
    EXPECT_NEAR(glm::length(sun.direction), 1, 1e-5f);
    // From the court's middle the way to the sun leaves through the opening between the eaves.
    const glm::vec3 at_roof = -sun.direction * (11.3f / -sun.direction.y);
    EXPECT_LT(std::abs(at_roof.x), 11.0f);
    EXPECT_LT(std::abs(at_roof.z), 6.0f);
    EXPECT_NE(scene_.environment_radiance, glm::vec3(0));
}

TEST_F(Atrium, NormalMapsAreUnitAndTileSeamlessly) {
    std::set<uint32_t> normal_maps;
    for (const Material& material : scene_.materials) {
        if (material.normal_texture)
            normal_maps.insert(scene_.textures[material.normal_texture->texture].image);
    }
    EXPECT_GE(normal_maps.size(), 6u);
    for (const uint32_t index : normal_maps) {
        const Image8& image = scene_.images[index];
        glm::dvec3 mean(0);
        for (size_t i = 0; i < image.values.size(); i += 4) {
            const glm::vec3 n =
                glm::vec3(image.values[i], image.values[i + 1], image.values[i + 2]) / 127.5f - 1.0f;
            ASSERT_NEAR(glm::length(n), 1, 0.015f);
            ASSERT_GT(n.z, 0);
            mean += n;
        }
        // Over a whole period of a height field the slopes cancel.
        mean /= double(image.width) * image.height;
        EXPECT_NEAR(mean.x, 0, 0.02);
        EXPECT_NEAR(mean.y, 0, 0.02);
    }
}

TEST_F(Atrium, TexturesGoOnSeamlesslyAtTheirEdges) {
    // Across the tile's edge neighbours differ no more than neighbours inside do.
    for (const Image8& image : scene_.images) {
        const auto difference = [&](uint32_t xa, uint32_t ya, uint32_t xb, uint32_t yb) {
            const uint8_t *a = image.at(xa, ya), *b = image.at(xb, yb);
            return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
        };
        const uint32_t n = image.width;
        double worst_inside_columns = 0, worst_inside_rows = 0, edge_columns = 0, edge_rows = 0;
        for (uint32_t i = 0; i + 1 < n; ++i) {
            double columns = 0, rows = 0;
            for (uint32_t k = 0; k < n; ++k) {
                columns += difference(i, k, i + 1, k);
                rows += difference(k, i, k, i + 1);
            }
            worst_inside_columns = std::max(worst_inside_columns, columns);
            worst_inside_rows = std::max(worst_inside_rows, rows);
        }
        for (uint32_t k = 0; k < n; ++k) {
            edge_columns += difference(n - 1, k, 0, k);
            edge_rows += difference(k, n - 1, k, 0);
        }
        EXPECT_LE(edge_columns, 1.1 * worst_inside_columns);
        EXPECT_LE(edge_rows, 1.1 * worst_inside_rows);
    }
}

TEST_F(Atrium, WallsAreThickEnoughForVoxels) {
    // Probes through each back wall and through the arcade wall over a column find a way in and a way out at
    // least 0.3 m apart.
    struct Crossing {
        float distance;
        bool enters;
    };
    const auto crossings = [&](glm::vec3 origin, glm::vec3 direction) {
        std::vector<Crossing> result;
        for (const Instance& instance : scene_.instances) {
            for (const Triangle& triangle : triangles_of(scene_, scene_.meshes[instance.mesh])) {
                glm::vec3 p[3];
                for (size_t i = 0; i < 3; ++i) {
                    p[i] = glm::vec3(instance.world_from_object * glm::vec4(triangle.corners[i].position, 1));
                }
                const glm::vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
                const float facing = glm::dot(normal, direction);
                if (facing == 0) continue;
                const float t = glm::dot(normal, p[0] - origin) / facing;
                const glm::vec3 x = origin + t * direction;
                bool inside = t > 0;
                for (size_t i = 0; i < 3; ++i) {
                    inside = inside && glm::dot(glm::cross(p[(i + 1) % 3] - p[i], x - p[i]), normal) >= 0;
                }
                if (inside) result.push_back({t, facing < 0});
            }
        }
        std::ranges::sort(result, {}, &Crossing::distance);
        return result;
    };
    const glm::vec3 origin(0.137f, 5.05f, 0.06f);
    for (const glm::vec3 direction : {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}) {
        for (const float height : {5.30f, 10.60f}) {
            const auto found = crossings({origin.x, height, origin.z}, direction);
            ASSERT_GE(found.size(), 2u);
            EXPECT_TRUE(found.front().enters);
            EXPECT_FALSE(found.back().enters);
            EXPECT_GT(found.back().distance - found.front().distance, 0.3f);
            // The outermost solid is the back wall.
            const auto last_entry = std::ranges::find_if(found.rbegin(), found.rend(), &Crossing::enters);
            ASSERT_NE(last_entry, found.rend());
            EXPECT_GE(found.back().distance - last_entry->distance, 0.3f);
        }
    }
}

}  // namespace
}  // namespace lumo::scene
