#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "techniques/shadow/shadow.hpp"

namespace lumo::shadow {
namespace {

/// The farthest corner of the bounds.
double reach_of(const scene::Bounds& bounds, glm::dvec3 position) {
    if (bounds.empty()) return 1;
    const glm::dvec3 farthest =
        glm::max(glm::abs(glm::dvec3(bounds.min) - position), glm::abs(glm::dvec3(bounds.max) - position));
    return glm::length(farthest);
}

/// Looks along z from a point; `x` and `y` are the axes of the map. All unit length, at right angles.
LightCamera perspective_camera(glm::dvec3 position, glm::dvec3 x, glm::dvec3 y, glm::dvec3 z,
                               double tan_half_angle, double reach, uint32_t resolution) {
    tan_half_angle *= resolution / (resolution - 4.0);
    const double near = 1e-3 * reach;
    glm::dmat4 clip_from_light(0);
    clip_from_light[0][0] = clip_from_light[1][1] = 1 / tan_half_angle;
    clip_from_light[2][2] = reach / (reach - near);
    clip_from_light[2][3] = 1;
    clip_from_light[3][2] = -reach * near / (reach - near);
    const glm::dmat4 light_from_world =
        glm::translate(glm::dmat4(glm::transpose(glm::dmat3(x, y, z))), -position);
    const glm::dmat4 clip_from_world = clip_from_light * light_from_world;
    return {.clip_from_world = glm::mat4(clip_from_world),
            .world_from_clip = glm::mat4(glm::inverse(clip_from_world)),
            .toward_light = glm::vec3(-z),
            .texel_size = glm::vec2(float(2 * tan_half_angle / resolution))};
}

}  // namespace

LightCamera fit_light(const scene::Bounds& bounds, glm::vec3 direction_to_light, uint32_t resolution) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(direction_to_light));
    const glm::dvec3 helper = std::abs(z.y) < 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
    const glm::dmat3 light_from_world = glm::transpose(glm::dmat3(x, glm::cross(z, x), z));

    const scene::Bounds box = bounds.empty() ? scene::Bounds{glm::vec3(-1), glm::vec3(1)} : bounds;
    const glm::dvec3 center = light_from_world * (0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)));
    const glm::dvec3 half_diagonal = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min));
    glm::dvec3 extent(0);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            extent[row] += std::abs(light_from_world[column][row]) * half_diagonal[column];
    // A flat scene still gets a volume.
    const double least = std::max(1e-3 * std::max({extent.x, extent.y, extent.z}), 1e-6);
    extent = glm::max(extent, glm::dvec3(least));
    extent.x *= resolution / (resolution - 4.0);
    extent.y *= resolution / (resolution - 4.0);
    extent.z *= 1.001;

    // z points to the light, depth away from it.
    glm::dmat4 clip_from_light(1);
    clip_from_light[0][0] = 1 / extent.x;
    clip_from_light[1][1] = 1 / extent.y;
    clip_from_light[2][2] = -0.5 / extent.z;
    clip_from_light[3] =
        glm::dvec4(-center.x / extent.x, -center.y / extent.y, 0.5 + 0.5 * center.z / extent.z, 1);
    const glm::dmat4 clip_from_world = clip_from_light * glm::dmat4(light_from_world);
    return {.clip_from_world = glm::mat4(clip_from_world),
            .world_from_clip = glm::mat4(glm::inverse(clip_from_world)),
            .toward_light = glm::vec3(z),
            .texel_size = glm::vec2(2 * extent.x / resolution, 2 * extent.y / resolution)};
}

uint32_t camera_count(const scene::Light& light) {
    const bool one = light.kind == scene::LightKind::directional ||
                     (light.kind == scene::LightKind::spot && light.outer_cone_angle <= glm::radians(60.0f));
    return one ? 1 : 6;
}

std::vector<scene::Light> drawn_lights(std::span<const scene::Light> lights) {
    std::vector<scene::Light> drawn;
    size_t cameras = 0;
    for (const scene::Light& light : lights) {
        const size_t count = camera_count(light);
        if (light.intensity == glm::vec3(0) || drawn.size() == max_lights || cameras + count > max_cameras)
            continue;
        cameras += count;
        drawn.push_back(light);
    }
    return drawn;
}

std::vector<LightCamera> cameras_of(const scene::Light& light, const scene::Bounds& bounds,
                                    uint32_t resolution) {
    if (light.kind == scene::LightKind::directional) return {fit_light(bounds, -light.direction, resolution)};

    const glm::dvec3 position(light.position);
    double reach = 1.001 * reach_of(bounds, position);
    if (light.range > 0) reach = std::min(reach, double(light.range));
    reach = std::max(reach, 1e-6);
    if (camera_count(light) == 1) {
        const glm::dvec3 z = glm::normalize(glm::dvec3(light.direction));
        const glm::dvec3 helper = std::abs(z.y) < 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
        const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
        return {perspective_camera(position, x, glm::cross(z, x), z, std::tan(double(light.outer_cone_angle)),
                                   reach, resolution)};
    }
    std::vector<LightCamera> cameras;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            glm::dvec3 x(0), y(0), z(0);
            x[(axis + 1) % 3] = 1;
            y[(axis + 2) % 3] = 1;
            z[axis] = sign;
            cameras.push_back(perspective_camera(position, x, y, z, 1, reach, resolution));
        }
    }
    return cameras;
}

}  // namespace lumo::shadow
