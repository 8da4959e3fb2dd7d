// What stands in for a camera and a light that a scene does not have.
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <vector>

#include "scene/scene.hpp"

namespace lumo::scene {
namespace {

struct Triangle {
    glm::vec3 corner;
    glm::vec3 edge_1;
    glm::vec3 edge_2;
};

std::vector<Triangle> world_triangles(const Scene& scene) {
    std::vector<Triangle> triangles;
    triangles.reserve(scene.triangle_count());
    for (const Instance& instance : scene.instances) {
        for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
            for (uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
                glm::vec3 p[3];
                for (uint32_t k = 0; k < 3; ++k) {
                    const uint32_t vertex = scene.indices[primitive.first_index + i + k];
                    p[k] = instance.world_from_object * glm::vec4(scene.vertices[vertex].position, 1);
                }
                triangles.push_back({p[0], p[1] - p[0], p[2] - p[0]});
            }
        }
    }
    return triangles;
}

struct Hit {
    float distance = std::numeric_limits<float>::infinity();
    bool front = false;  ///< of a counter-clockwise triangle
};

/// The nearest triangle along a ray (Möller & Trumbore 1997).
Hit nearest_hit(const std::vector<Triangle>& triangles, glm::vec3 origin, glm::vec3 direction) {
    Hit nearest;
    for (const Triangle& triangle : triangles) {
        const glm::vec3 p = glm::cross(direction, triangle.edge_2);
        const float determinant = glm::dot(triangle.edge_1, p);
        if (determinant == 0) continue;
        const glm::vec3 t = origin - triangle.corner;
        const float u = glm::dot(t, p) / determinant;
        const glm::vec3 q = glm::cross(t, triangle.edge_1);
        const float v = glm::dot(direction, q) / determinant;
        const float distance = glm::dot(triangle.edge_2, q) / determinant;
        if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest.distance) continue;
        nearest = {distance, determinant > 0};
    }
    return nearest;
}

/// A camera inside a scene whose middle is surrounded, looking along the longest clear line through it.
bool look_along_room(const Scene& scene, const Bounds& bounds, Camera& camera) {
    // Beyond it the rays would take longer than the picture.
    constexpr uint64_t most_triangles = 2'000'000;
    if (scene.triangle_count() > most_triangles) return false;
    const std::vector<Triangle> triangles = world_triangles(scene);

    const glm::vec3 center = 0.5f * (bounds.min + bounds.max);
    const Hit floor = nearest_hit(triangles, center, {0, -1, 0});
    if (!std::isfinite(floor.distance)) return false;
    const float floor_height = center.y - floor.distance;
    const glm::vec3 eye(center.x, floor_height + 0.2f * (bounds.max.y - floor_height), center.z);

    constexpr int directions = 32;  // even: each has its opposite
    std::vector<Hit> hits;
    const auto direction = [](int i) {
        const float azimuth = glm::two_pi<float>() * float(i) / directions;
        return glm::vec3(std::cos(azimuth), 0, std::sin(azimuth));
    };
    for (int i = 0; i < directions; ++i) hits.push_back(nearest_hit(triangles, eye, direction(i)));
    // Fronts of surfaces all around: a room. Backs: the inside of a solid thing.
    const auto walls = std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return hit.front; });
    if (walls < directions * 7 / 8) return false;

    int longest = 0;
    float length = 0;
    for (int i = 0; i < directions; ++i) {
        const float line =
            std::min(hits[size_t(i)].distance + hits[size_t(i + directions / 2) % directions].distance,
                     2 * glm::length(bounds.max - bounds.min));
        if (line > length * 1.001f) {
            length = line;
            longest = i;
        }
    }
    const float behind = std::min(hits[size_t(longest + directions / 2) % directions].distance, length);
    // Away from the wall behind, and from the arches that tend to stand there.
    camera.position = eye - 0.6f * behind * direction(longest);
    camera.target = eye + 0.05f * length * glm::vec3(0, 1, 0);
    camera.vertical_fov = glm::radians(60.0f);
    camera.near_plane = 1e-3f * length;
    camera.far_plane = 2 * glm::length(bounds.max - bounds.min);
    return true;
}

}  // namespace

Camera default_camera(const Scene& scene) {
    if (!scene.cameras.empty()) return scene.cameras.front();
    Camera camera;
    camera.name = "default";
    const Bounds bounds = world_bounds(scene);
    if (bounds.empty() || look_along_room(scene, bounds, camera)) return camera;

    const glm::vec3 center = 0.5f * (bounds.min + bounds.max);
    // A point or nothing but one point still gets a picture.
    const float radius = std::max(0.5f * glm::length(bounds.max - bounds.min), 1e-3f);
    const float distance = 1.05f * radius / std::sin(0.5f * camera.vertical_fov);
    camera.target = center;
    camera.position = center + distance * glm::normalize(glm::vec3(0.35f, 0.3f, 1));
    camera.near_plane = std::max(0.5f * (distance - radius), 1e-3f * distance);
    camera.far_plane = 2 * (distance + radius);
    return camera;
}

bool has_light(const Scene& scene) {
    const auto emits = [&](const Instance& instance) {
        const std::vector<Primitive>& primitives = scene.meshes[instance.mesh].primitives;
        return std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& primitive) {
            return scene.materials[primitive.material].emits();
        });
    };
    return !scene.lights.empty() || scene.environment_radiance != glm::vec3(0) ||
           std::any_of(scene.instances.begin(), scene.instances.end(), emits);
}

void add_daylight(Scene& scene) {
    // White paper that faces the sun has a radiance of about 2, in the shade of an open sky about a half.
    scene.lights.push_back({.name = "daylight",
                            .intensity = {6.5f, 6.1f, 5.5f},
                            .direction = -glm::normalize(glm::vec3(0.25f, 1, 0.15f))});
    scene.environment_radiance = {0.4f, 0.5f, 0.62f};
}

}  // namespace lumo::scene
