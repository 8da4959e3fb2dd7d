#include "samples/embed-gl/host.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>
#include <string>

namespace embed {
namespace {

constexpr int shadow_side = 1024;

constexpr const char* surface_vertex = R"(#version 450
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
layout(location = 2) in vec3 color_in;
layout(location = 0) uniform mat4 clip_from_world;
out vec3 normal;
out vec3 color;

void main() {
    normal = normal_in;
    color = color_in;
    gl_Position = clip_from_world * vec4(position, 1);
})";

constexpr const char* surface_fragment = R"(#version 450
in vec3 normal;
in vec3 color;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 world_normal;

void main() {
    albedo = vec4(color, 1);
    world_normal = vec4(normalize(normal), 1);
})";

constexpr const char* compose_vertex = R"(#version 450
// One triangle over the whole picture.
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); })";

constexpr const char* compose_fragment = R"(#version 450
layout(binding = 0) uniform sampler2D albedo;
layout(binding = 1) uniform sampler2D normal;
layout(binding = 2) uniform sampler2D depth;
layout(binding = 3) uniform sampler2DShadow shadow;
layout(binding = 4) uniform sampler2D irradiance;
layout(location = 0) uniform mat4 world_from_clip;
layout(location = 1) uniform mat4 shadow_from_world;
layout(location = 2) uniform vec3 toward_sun;
layout(location = 3) uniform vec3 sun;
layout(location = 4) uniform vec3 sky;
layout(location = 5) uniform bool with_indirect;
out vec4 result;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float d = texelFetch(depth, pixel, 0).r;
    vec3 radiance = sky;
    if (d < 1.0) {
        vec3 clip = vec3(gl_FragCoord.xy / vec2(textureSize(depth, 0)), d) * 2.0 - 1.0;
        vec4 world = world_from_clip * vec4(clip, 1);
        vec3 n = texelFetch(normal, pixel, 0).xyz;
        vec4 seen = shadow_from_world * vec4(world.xyz / world.w + n * 0.03, 1);
        float lit = textureLod(shadow, seen.xyz * 0.5 + 0.5, 0.0);
        vec3 light = sun * max(dot(n, toward_sun), 0.0) * lit;
        if (with_indirect) light += texelFetch(irradiance, pixel, 0).rgb;
        radiance = texelFetch(albedo, pixel, 0).rgb * light / 3.14159265;
    }
    result = vec4(1.0 - exp(-radiance), 1);
})";

constexpr const char* triangle_vertex = R"(#version 450
out vec3 color;

// In the picture's lower left corner.
void main() {
    vec2 p = vec2[](vec2(-0.94, -0.92), vec2(-0.74, -0.92), vec2(-0.84, -0.6))[gl_VertexID];
    color = mat3(1)[gl_VertexID];
    gl_Position = vec4(p, 0, 1);
})";

constexpr const char* triangle_fragment = R"(#version 450
in vec3 color;
out vec4 result;
void main() { result = vec4(color, 1); })";

GLuint make_program(const char* vertex, const char* fragment) {
    const GLuint program = glCreateProgram();
    for (const auto& [stage, text] :
         {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
        const GLuint shader = glCreateShader(GLenum(stage));
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
        std::string log(4096, '\0');
        glGetProgramInfoLog(program, GLsizei(log.size()), nullptr, log.data());
        throw std::runtime_error("a program of the host's: " + log);
    }
    return program;
}

void add_quad(Mesh& mesh, glm::vec3 center, glm::vec3 u, glm::vec3 v, glm::vec3 color) {
    const auto first = uint32_t(mesh.vertices.size());
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    for (const glm::vec2 corner : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        mesh.vertices.push_back({center + corner.x * u + corner.y * v, normal, color});
    for (uint32_t corner : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + corner);
}

void add_box(Mesh& mesh, glm::vec3 center, glm::vec3 half, glm::vec3 color) {
    for (int axis = 0; axis < 3; ++axis) {
        for (float side : {-1.0f, 1.0f}) {
            glm::vec3 out(0), u(0), v(0);
            out[axis] = side * half[axis];
            u[(axis + 1) % 3] = side * half[(axis + 1) % 3];
            v[(axis + 2) % 3] = half[(axis + 2) % 3];
            add_quad(mesh, center + out, u, v, color);
        }
    }
}

void add_sphere(Mesh& mesh, glm::vec3 center, float radius, glm::vec3 color) {
    constexpr uint32_t around = 48, down = 24;
    const auto first = uint32_t(mesh.vertices.size());
    for (uint32_t i = 0; i <= down; ++i) {
        for (uint32_t j = 0; j <= around; ++j) {
            const float theta = 3.14159265f * float(i) / down, phi = 6.2831853f * float(j) / around;
            const glm::vec3 normal{std::sin(theta) * std::sin(phi), std::cos(theta),
                                   std::sin(theta) * std::cos(phi)};
            mesh.vertices.push_back({center + radius * normal, normal, color});
        }
    }
    for (uint32_t i = 0; i < down; ++i) {
        for (uint32_t j = 0; j < around; ++j) {
            const uint32_t a = first + i * (around + 1) + j, b = a + around + 1;
            for (uint32_t corner : {a, b, b + 1, a, b + 1, a + 1}) mesh.indices.push_back(corner);
        }
    }
}

Mesh make_scene() {
    constexpr glm::vec3 white{0.75f, 0.75f, 0.72f};
    Mesh mesh;
    add_box(mesh, {0, -0.2f, 0}, {5, 0.2f, 5}, white);
    add_box(mesh, {0, 2, -5.2f}, {5, 2.4f, 0.2f}, white);
    add_box(mesh, {-5.2f, 2, 0}, {0.2f, 2.4f, 5}, {0.08f, 0.2f, 0.7f});
    add_box(mesh, {5.2f, 2, 0}, {0.2f, 2.4f, 5}, {0.8f, 0.35f, 0.05f});
    add_box(mesh, {-1.6f, 1.3f, -1.8f}, {0.9f, 1.3f, 0.9f}, white);
    add_box(mesh, {0.2f, 0.4f, 2.2f}, {0.7f, 0.4f, 0.7f}, {0.7f, 0.08f, 0.1f});
    add_sphere(mesh, {2.3f, 1.2f, -0.4f}, 1.2f, white);
    return mesh;
}

glm::mat4 clip_from_world(const Camera& camera, float aspect) {
    return glm::perspectiveRH_NO(camera.vertical_fov, aspect, camera.near_plane, camera.far_plane) *
           glm::lookAtRH(camera.position, camera.target, glm::vec3(0, 1, 0));
}

glm::mat4 shadow_from_world() {
    return glm::orthoRH_NO(-9.0f, 9.0f, -9.0f, 9.0f, 1.0f, 40.0f) *
           glm::lookAtRH(20.0f * toward_sun, glm::vec3(0), glm::vec3(0, 1, 0));
}

void GLAPIENTRY on_message(GLenum, GLenum, GLuint, GLenum severity, GLsizei, const GLchar* text,
                           const void* counter) {
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    std::fprintf(stderr, "embed-gl: %s\n", text);
    ++*static_cast<int*>(const_cast<void*>(counter));
}

}  // namespace

Host::Host(int width, int height) : width_(width), height_(height), mesh_(make_scene()) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, &messages_);
    make_mesh_buffers();
    make_framebuffers();
    surface_program_ = make_program(surface_vertex, surface_fragment);
    compose_program_ = make_program(compose_vertex, compose_fragment);
    triangle_program_ = make_program(triangle_vertex, triangle_fragment);
}

Host::~Host() {
    for (GLuint program : {surface_program_, compose_program_, triangle_program_}) glDeleteProgram(program);
    for (GLuint target : {shadow_target_, surface_target_, picture_target_}) glDeleteFramebuffers(1, &target);
    for (GLuint texture : {shadow_, albedo_, normal_, depth_, irradiance_, picture_})
        glDeleteTextures(1, &texture);
    for (GLuint buffer : {vertices_, indices_}) glDeleteBuffers(1, &buffer);
    for (GLuint array : {mesh_array_, empty_array_}) glDeleteVertexArrays(1, &array);
    glDeleteSamplers(1, &shadow_sampler_);
    glDebugMessageCallback(nullptr, nullptr);
}

void Host::make_mesh_buffers() {
    glCreateBuffers(1, &vertices_);
    glNamedBufferStorage(vertices_, GLsizeiptr(mesh_.vertices.size() * sizeof(Vertex)), mesh_.vertices.data(),
                         0);
    glCreateBuffers(1, &indices_);
    glNamedBufferStorage(indices_, GLsizeiptr(mesh_.indices.size() * 4), mesh_.indices.data(), 0);
    glCreateVertexArrays(1, &mesh_array_);
    glVertexArrayVertexBuffer(mesh_array_, 0, vertices_, 0, sizeof(Vertex));
    glVertexArrayElementBuffer(mesh_array_, indices_);
    for (GLuint i = 0; i < 3; ++i) {
        glEnableVertexArrayAttrib(mesh_array_, i);
        glVertexArrayAttribFormat(mesh_array_, i, 3, GL_FLOAT, GL_FALSE, i * GLuint(sizeof(glm::vec3)));
        glVertexArrayAttribBinding(mesh_array_, i, 0);
    }
    glCreateVertexArrays(1, &empty_array_);
}

GLuint Host::make_texture(GLenum format, int width, int height) const {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, 1, format, width, height);
    return name;
}

void Host::make_framebuffers() {
    shadow_ = make_texture(GL_DEPTH_COMPONENT24, shadow_side, shadow_side);
    albedo_ = make_texture(GL_RGBA8, width_, height_);
    normal_ = make_texture(GL_RGBA16F, width_, height_);
    depth_ = make_texture(GL_DEPTH_COMPONENT32F, width_, height_);
    irradiance_ = make_texture(GL_RGBA32F, width_, height_);
    picture_ = make_texture(GL_SRGB8_ALPHA8, width_, height_);

    glCreateFramebuffers(1, &shadow_target_);
    glNamedFramebufferTexture(shadow_target_, GL_DEPTH_ATTACHMENT, shadow_, 0);
    glCreateFramebuffers(1, &surface_target_);
    glNamedFramebufferTexture(surface_target_, GL_COLOR_ATTACHMENT0, albedo_, 0);
    glNamedFramebufferTexture(surface_target_, GL_COLOR_ATTACHMENT1, normal_, 0);
    glNamedFramebufferTexture(surface_target_, GL_DEPTH_ATTACHMENT, depth_, 0);
    const std::array<GLenum, 2> colors{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(surface_target_, colors.size(), colors.data());
    glCreateFramebuffers(1, &picture_target_);
    glNamedFramebufferTexture(picture_target_, GL_COLOR_ATTACHMENT0, picture_, 0);

    glCreateSamplers(1, &shadow_sampler_);
    glSamplerParameteri(shadow_sampler_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(shadow_sampler_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

void Host::draw_surfaces(const Camera& camera) {
    const auto draw_mesh = [&](const glm::mat4& matrix) {
        glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(matrix));
        glDrawElements(GL_TRIANGLES, GLsizei(mesh_.indices.size()), GL_UNSIGNED_INT, nullptr);
    };
    glUseProgram(surface_program_);
    glBindVertexArray(mesh_array_);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);

    glBindFramebuffer(GL_FRAMEBUFFER, shadow_target_);
    glViewport(0, 0, shadow_side, shadow_side);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2, 4);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_mesh(shadow_from_world());
    glDisable(GL_POLYGON_OFFSET_FILL);

    glBindFramebuffer(GL_FRAMEBUFFER, surface_target_);
    glViewport(0, 0, width_, height_);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_mesh(clip_from_world(camera, float(width_) / float(height_)));

    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glUseProgram(compose_program_);
    glBindVertexArray(empty_array_);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_target_);
    GLuint unit = 0;
    for (GLuint texture : {albedo_, normal_, depth_, shadow_, irradiance_})
        glBindTextureUnit(unit++, texture);
    glBindSampler(3, shadow_sampler_);
}

void Host::compose(const Camera& camera, bool with_indirect) const {
    const glm::mat4 world_from_clip = glm::inverse(clip_from_world(camera, float(width_) / float(height_)));
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(world_from_clip));
    glUniformMatrix4fv(1, 1, GL_FALSE, glm::value_ptr(shadow_from_world()));
    glUniform3fv(2, 1, glm::value_ptr(toward_sun));
    glUniform3fv(3, 1, glm::value_ptr(sun_irradiance));
    glUniform3fv(4, 1, glm::value_ptr(sky_radiance));
    glUniform1i(5, with_indirect);
    glDrawArrays(GL_TRIANGLES, 0, 3);

    glUseProgram(triangle_program_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindSampler(3, 0);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

std::vector<uint8_t> Host::read_picture() const {
    std::vector<uint8_t> texels(size_t(width_) * size_t(height_) * 4);
    glGetTextureImage(picture_, 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(texels.size()), texels.data());
    return texels;
}

void Host::show() const {
    glBlitNamedFramebuffer(picture_target_, 0, 0, 0, width_, height_, 0, 0, width_, height_,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace embed
