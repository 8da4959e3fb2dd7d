#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/geometry.hpp"

namespace lumo::scene::builtin {
namespace {

/// The volume that a closed surface holds, positive where its fronts look outward.
double volume(const Geometry& geometry) {
    double six_times = 0;
    for (size_t i = 0; i < geometry.indices.size(); i += 3) {
        const auto p = [&](size_t k) {
            return glm::dvec3(geometry.vertices[geometry.indices[i + k]].position);
        };
        six_times += glm::dot(p(0), glm::cross(p(1), p(2)));
    }
    return six_times / 6;
}

/// The worst alignment of a corner's normal with its triangle.
float worst_facing(const Geometry& geometry) {
    float worst = 1;
    for (size_t i = 0; i < geometry.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return geometry.vertices[geometry.indices[i + k]]; };
        const glm::vec3 normal = glm::normalize(
            glm::cross(corner(1).position - corner(0).position, corner(2).position - corner(0).position));
        for (size_t k = 0; k < 3; ++k) worst = std::min(worst, glm::dot(normal, corner(k).normal));
    }
    return worst;
}

Bounds bounds(const Geometry& geometry) {
    Bounds result;
    for (const Vertex& vertex : geometry.vertices) result.add(vertex.position);
    return result;
}

TEST(Geometry, SolidsHoldTheirVolumeOutwardSideOut) {
    EXPECT_NEAR(volume(box({-1, 2, 3}, {1, 5, 7})), 2 * 3 * 4, 1e-5);
    const float pi = glm::pi<float>();
    EXPECT_NEAR(volume(sphere(2, 64, 32)), 4.0 / 3 * pi * 8, 0.2);
    // A cylinder with its two discs, as a polygon's area times its height.
    const Profile can{{{0, 0}, {1, 0}, {1, 3}, {0, 3}}};
    EXPECT_NEAR(volume(lathe(can, 8)), 3 * 0.5 * 8 * std::sin(pi / 4), 1e-5);
    // The same profile as a prism, where x is the apothem.
    EXPECT_NEAR(volume(prism(can, 8)), 3 * 8 * std::tan(pi / 8), 1e-5);
    EXPECT_NEAR(volume(block({{{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}}},
                             {{{0, 2, 1}, {1, 2, 1}, {1, 2, 0}, {0, 2, 0}}})),
                2, 1e-6);
    EXPECT_NEAR(volume(reversed(box({0, 0, 0}, {1, 1, 1}))), -1, 1e-6);
}

TEST(Geometry, FlatSolidsHaveFlatNormals) {
    EXPECT_GT(worst_facing(box({0, 0, 0}, {1, 2, 3})), 0.9999f);
    EXPECT_GT(worst_facing(prism({{{0, 0}, {1, 0}, {1, 1}, {0, 2}}}, 6)), 0.9999f);
    EXPECT_GT(worst_facing(faceted_sphere(1, 12, 6)), 0.9999f);
    EXPECT_GT(worst_facing(reversed(box({0, 0, 0}, {1, 2, 3}))), 0.9999f);
}

TEST(Geometry, MirroredPlacementKeepsFrontsInFrontAndTurnsTheTangentFrame) {
    const glm::mat4 mirror(glm::vec4(-1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0),
                           glm::vec4(5, 0, 0, 1));
    Geometry placed;
    append(placed, box({0, 0, 0}, {1, 1, 1}), mirror);
    EXPECT_NEAR(volume(placed), 1, 1e-6);
    EXPECT_GT(worst_facing(placed), 0.9999f);
    for (const Vertex& vertex : placed.vertices) EXPECT_EQ(vertex.tangent.w, -1);
}

TEST(Geometry, StretchedPlacementKeepsNormalsPerpendicular) {
    const glm::mat4 stretch(glm::vec4(4, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0.5f, 0, 1, 0),
                            glm::vec4(0, 0, 0, 1));
    Geometry placed;
    append(placed, faceted_sphere(1, 16, 8), stretch);
    EXPECT_GT(worst_facing(placed), 0.999f);
    for (const Vertex& vertex : placed.vertices) {
        ASSERT_NEAR(glm::dot(vertex.normal, glm::vec3(vertex.tangent)), 0, 1e-5f);
    }
}

TEST(Geometry, ProfilesStaySharpOnlyBeyondTheCreaseAngle) {
    const Profile bent{{{1, 0}, {1, 1}, {0.8f, 2}}};       // 11 degrees
    const Profile folded{{{1, 0}, {1, 1}, {0, 1}}};        // 90 degrees
    EXPECT_EQ(lathe(bent, 8).vertices.size(), 9u * 3);     // one column for each point
    EXPECT_EQ(lathe(folded, 8).vertices.size(), 9u * 4);   // the corner twice
    EXPECT_GT(worst_facing(lathe(folded, 256)), 0.9999f);  // facets aside, faces are flat
}

TEST(Geometry, MitresShortenInnerAndLengthenOuterCorners) {
    const Profile ledge{{{0.5f, 0}, {0.5f, 1}}};
    const auto extent = [&](float start, float end) {
        const Bounds b = bounds(moulding(ledge, 10, start, end));
        EXPECT_NEAR(b.max.z, 0.5f, 1e-6f);
        return glm::vec2(b.min.x, b.max.x);
    };
    EXPECT_EQ(extent(0, 0), glm::vec2(0, 10));
    EXPECT_EQ(extent(1, 1), glm::vec2(0.5f, 9.5f));
    EXPECT_EQ(extent(-1, 0), glm::vec2(-0.5f, 10));
}

TEST(Geometry, ArchivoltSpansItsRadii) {
    const Profile band{{{-0.2f, 0}, {0.2f, 0}}};  // an intrados, seen from the arch's centre
    const Geometry arch = archivolt(band, {2, 1}, 16);
    const Bounds b = bounds(arch);
    EXPECT_NEAR(b.min.x, -2, 1e-6f);
    EXPECT_NEAR(b.max.x, 2, 1e-6f);
    EXPECT_NEAR(b.min.y, 0, 1e-6f);
    EXPECT_NEAR(b.max.y, 1, 1e-6f);
    EXPECT_NEAR(b.max.z, 0.2f, 1e-6f);
    for (const Vertex& vertex : arch.vertices) EXPECT_LT(glm::dot(vertex.normal, vertex.position), 0);
    EXPECT_GT(worst_facing(arch), 0.95f);
}

TEST(Geometry, ShrunkenEdgesLeaveNoTriangleWithoutArea) {
    // A cone over a unit circle: the grid's upper edge is one point.
    const Geometry cone = grid({.columns = 16, .rows = 4, .metres = {1, 1}}, [](float s, float t) {
        const float angle = 2 * glm::pi<float>() * s;
        return glm::vec3((1 - t) * std::sin(angle), t, (1 - t) * std::cos(angle));
    });
    EXPECT_EQ(cone.indices.size(), 3u * (16 * 4 * 2 - 16));
    for (const Vertex& vertex : cone.vertices) ASSERT_NEAR(glm::length(vertex.normal), 1, 1e-5f);
    EXPECT_GT(worst_facing(cone), 0.9f);
}

TEST(Geometry, UvIsInMetresUntilTheFinishIsKnown) {
    Scene scene;
    const Finish stone{add_diffuse_material(scene, "stone", glm::vec3(0.5f)), 2.5f};
    Model model;
    append(model[stone], parallelogram({0, 0, 0}, {5, 0, 0}, {0, 10, 0}));
    const uint32_t mesh = add_mesh(scene, "wall", model);
    ASSERT_EQ(scene.meshes[mesh].primitives.size(), 1u);
    EXPECT_EQ(scene.meshes[mesh].primitives[0].material, stone.material);
    EXPECT_EQ(scene.vertices[2].uv0, glm::vec2(2, -4));
}

}  // namespace
}  // namespace lumo::scene::builtin
