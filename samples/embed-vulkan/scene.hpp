// The host's scene: boxes of one colour each under a sun and a sky. Laid out as shaders/boxes.glsl reads it.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace embed {

struct Box {
    glm::vec4 center;     ///< metres; w unused
    glm::vec4 half_size;  ///< metres; w unused
    glm::vec4 color;      ///< linear; w unused
};

inline constexpr std::array boxes{
    Box{{0, -0.2, 0, 0}, {5, 0.2, 5, 0}, {0.75, 0.75, 0.72, 0}},    // floor
    Box{{0, 2, -5.2, 0}, {5, 2.4, 0.2, 0}, {0.75, 0.75, 0.72, 0}},  // back
    Box{{-5.2, 2, 0, 0}, {0.2, 2.4, 5, 0}, {0.75, 0.08, 0.05, 0}},  // left
    Box{{5.2, 2, 0, 0}, {0.2, 2.4, 5, 0}, {0.08, 0.6, 0.1, 0}},     // right
    Box{{-2.6, 1.5, -2.2, 0}, {0.8, 1.5, 0.8, 0}, {0.75, 0.75, 0.72, 0}},
    Box{{1.2, 0.8, 0.4, 0}, {0.8, 0.8, 0.8, 0}, {0.75, 0.75, 0.72, 0}},
    Box{{2.9, 0.5, -2.6, 0}, {0.9, 0.5, 0.9, 0}, {0.1, 0.2, 0.75, 0}},
};

inline const glm::vec3 toward_sun = glm::normalize(glm::vec3(0.75f, 1, 0.35f));
inline constexpr glm::vec3 sun_irradiance{3.6f, 3.3f, 2.9f};  ///< W/m² on a plane that faces it
inline constexpr glm::vec3 sky_radiance{0.07f, 0.11f, 0.19f};

struct Camera {
    glm::vec3 position{0.4f, 3.2f, 9.6f};
    glm::vec3 target{0, 1.4f, 0};
    float vertical_fov = 0.75f;  ///< radians
    float near_plane = 0.1f;
    float far_plane = 100;
};

}  // namespace embed
