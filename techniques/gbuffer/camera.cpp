#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::gbuffer {

CameraBlock camera_block(const scene::Camera& camera, rhi::Extent size) {
    // In double precision: floats hold the results, not what cancels on the way to them.
    const glm::dvec3 position(camera.position);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(camera.target) - position);
    glm::dvec3 up(camera.up);
    if (glm::length(glm::cross(axis, glm::normalize(up))) < 1e-6) up = {0, 0, -1};
    const glm::dvec3 right = glm::normalize(glm::cross(axis, up));
    up = glm::cross(right, axis);

    const double aspect = double(size.width) / size.height;
    const double near = double(camera.near_plane);
    const double far = double(camera.far_plane);
    const bool orthographic = camera.orthographic_height.has_value();
    // Metres, on the plane one metre ahead for a perspective.
    const double half_height = orthographic ? 0.5 * double(*camera.orthographic_height)
                                            : std::tan(0.5 * double(camera.vertical_fov));
    const double half_width = aspect * half_height;
    const glm::dmat4 clip_from_view =
        orthographic ? glm::orthoRH_ZO(-half_width, half_width, -half_height, half_height, near, far)
                     : glm::perspectiveRH_ZO(double(camera.vertical_fov), aspect, near, far);
    const glm::dvec3 origin = orthographic ? position : glm::dvec3(0);
    const glm::dvec3 corner = (orthographic ? position : axis) - half_width * right - half_height * up;
    return {
        .clip_from_offset = glm::mat4(clip_from_view * glm::lookAtRH(origin, origin + axis, up)),
        .eye = glm::vec4(orthographic ? glm::dvec4(-axis, 0) : glm::dvec4(position, 1)),
        .corner = glm::vec3(corner),
        .depth_offset = float(orthographic ? far : 1 / far),
        .across = glm::vec3(2 * half_width / size.width * right),
        .depth_scale = float(orthographic ? near - far : 1 / near - 1 / far),
        .along = glm::vec3(2 * half_height / size.height * up),
    };
}

}  // namespace lumo::gbuffer
