// A small renderer that knows nothing of lumo: plain OpenGL 4.5 with vertex arrays, framebuffers and uniforms. It draws
// a shadow map and a G-buffer of its scene, shades them with its sun, and draws a triangle of its own over the picture.
// It keeps OpenGL's usual conventions: depth from -1 to 1 in clip space, no sRGB conversion but where it asks for it.
#pragma once

#include <cstdint>
#include <epoxy/gl.h>
#include <glm/glm.hpp>
#include <vector>

namespace embed {

struct Vertex {
    glm::vec3 position;  ///< metres
    glm::vec3 normal;
    glm::vec3 color;  ///< linear
};

struct Mesh {
    std::vector<Vertex> vertices;
    std::vector<uint32_t> indices;
};

struct Camera {
    glm::vec3 position{0.3f, 3.2f, 10.5f};
    glm::vec3 target{0, 1.6f, 0};
    float vertical_fov = 0.75f;  ///< radians
    float near_plane = 0.1f;
    float far_plane = 100;
};

inline const glm::vec3 toward_sun = glm::normalize(glm::vec3(-0.6f, 1, 0.5f));
inline constexpr glm::vec3 sun_irradiance{5.5f, 5.1f, 4.5f};  ///< W/m² on a plane that faces it
inline constexpr glm::vec3 sky_radiance{0.1f, 0.17f, 0.32f};

class Host {
  public:
    /// In the current context, a debug one. Throws std::runtime_error where a shader does not compile.
    Host(int width, int height);
    ~Host();
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

    /// The scene's surfaces into albedo, normal and depth, and their shadows into the shadow map. What composes the
    /// picture is bound afterwards.
    void draw_surfaces(const Camera& camera);
    /// The picture from these: sunlight, and where asked the indirect irradiance; then the triangle. Takes for granted
    /// what draw_surfaces bound.
    void compose(const Camera& camera, bool with_indirect) const;
    /// The picture's texels, RGBA with 8 bits each, row 0 at the bottom.
    std::vector<uint8_t> read_picture() const;
    /// Into the window.
    void show() const;

    // What a guest is told.
    int width() const { return width_; }
    int height() const { return height_; }
    const Mesh& mesh() const { return mesh_; }
    GLuint normal() const { return normal_; }          ///< GL_RGBA16F, world space; 0 in the sky
    GLuint depth() const { return depth_; }            ///< GL_DEPTH_COMPONENT32F, 1 in the sky
    GLuint irradiance() const { return irradiance_; }  ///< GL_RGBA32F, W/m²
    /// Of the debug callback so far, notifications apart.
    int messages() const { return messages_; }

  private:
    GLuint make_texture(GLenum format, int width, int height) const;
    void make_mesh_buffers();
    void make_framebuffers();

    int width_, height_;
    int messages_ = 0;
    Mesh mesh_;
    GLuint vertices_ = 0, indices_ = 0, mesh_array_ = 0, empty_array_ = 0;
    GLuint shadow_ = 0, albedo_ = 0, normal_ = 0, depth_ = 0, irradiance_ = 0, picture_ = 0;
    GLuint shadow_target_ = 0, surface_target_ = 0, picture_target_ = 0;
    GLuint surface_program_ = 0, compose_program_ = 0, triangle_program_ = 0;
    GLuint shadow_sampler_ = 0;
};

}  // namespace embed
