#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::gbuffer {

CameraBlock camera_block(const scene::Camera& camera, rhi::Extent size) {
    // Doubles: the inverse of a product of matrices would otherwise lose what depth can tell.
    const glm::dvec3 position(camera.position);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(camera.target) - position);
    glm::dvec3 up(camera.up);
    if (glm::length(glm::cross(axis, glm::normalize(up))) < 1e-6) up = {0, 0, -1};

    const double aspect = double(size.width) / size.height;
    const double near = double(camera.near_plane);
    const double far = double(camera.far_plane);
    glm::dmat4 clip_from_view;
    glm::dvec4 eye(position, 1);
    if (camera.orthographic_height) {
        const double half_height = 0.5 * double(*camera.orthographic_height);
        const double half_width = aspect * half_height;
        clip_from_view = glm::orthoRH_ZO(-half_width, half_width, -half_height, half_height, near, far);
        eye = {-axis, 0};
    } else {
        clip_from_view = glm::perspectiveRH_ZO(double(camera.vertical_fov), aspect, near, far);
    }
    const glm::dmat4 clip_from_world = clip_from_view * glm::lookAtRH(position, position + axis, up);
    return {.clip_from_world = glm::mat4(clip_from_world),
            .world_from_clip = glm::mat4(glm::inverse(clip_from_world)),
            .eye = glm::vec4(eye),
            .inverse_size = {1 / float(size.width), 1 / float(size.height)}};
}

}  // namespace lumo::gbuffer
