// A scene on the CPU: what a file or a generator says, checked and in one form, before any GPU sees it.
//
// World space is right-handed, +Y up, in metres. Light is radiometric, linear Rec. 709. Triangles are
// counter-clockwise seen from their front.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "scene/atmosphere.hpp"
#include "scene/image.hpp"

namespace lumo::scene {

/// An axis-aligned box; empty (min > max) until something is added.
struct Bounds {
    glm::vec3 min{std::numeric_limits<float>::max()};
    glm::vec3 max{std::numeric_limits<float>::lowest()};

    bool empty() const { return min.x > max.x; }
    void add(glm::vec3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

struct Vertex {
    glm::vec3 position{0};          ///< object space, metres
    glm::vec3 normal{0, 1, 0};      ///< object space, unit length
    glm::vec4 tangent{1, 0, 0, 1};  ///< xyz unit length; bitangent = w * cross(normal, tangent), w is 1 or -1
    glm::vec2 uv0{0};               ///< glTF's: origin at the top left of the image
    glm::vec2 uv1{0};
    glm::vec4 color{1};  ///< linear, multiplies the base colour
};

enum class Filter : uint8_t { nearest, linear };
enum class Wrap : uint8_t { repeat, mirrored_repeat, clamp_to_edge };

struct TextureSampler {
    Filter magnification = Filter::linear;
    Filter minification = Filter::linear;
    std::optional<Filter> mip = Filter::linear;  ///< none: level 0 only
    Wrap wrap_u = Wrap::repeat;
    Wrap wrap_v = Wrap::repeat;

    bool operator==(const TextureSampler&) const = default;
};

struct Texture {
    uint32_t image = 0;  ///< index into Scene::images
    TextureSampler sampler;
};

/// Where a material reads a texture. uv' = (uv_transform * (uv, 1)).xy, from KHR_texture_transform.
struct TextureSlot {
    uint32_t texture = 0;  ///< index into Scene::textures
    uint32_t uv_set = 0;   ///< 0 or 1
    glm::mat3 uv_transform{1};
};

enum class AlphaMode : uint8_t { opaque, mask, blend };

/// glTF's metallic-roughness material. Base colour and emission textures are sRGB, the others linear.
struct Material {
    std::string name = {};
    glm::vec4 base_color{1};  ///< linear; multiplies texture and vertex colour
    float metallic = 1;
    float roughness = 1;    ///< perceptual; alpha = roughness²
    glm::vec3 emission{0};  ///< radiance, W/m²/sr, emissive strength included; multiplies its texture
    float normal_scale = 1;
    float occlusion_strength = 1;
    std::optional<TextureSlot> base_color_texture = {};
    std::optional<TextureSlot> metallic_roughness_texture = {};  ///< G roughness, B metallic
    std::optional<TextureSlot> normal_texture = {};     ///< tangent space, +Y up (OpenGL's convention)
    std::optional<TextureSlot> occlusion_texture = {};  ///< R
    std::optional<TextureSlot> emission_texture = {};
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;  ///< for mask
    bool double_sided = false;
    bool unlit = false;

    bool emits() const { return emission != glm::vec3(0); }
};

/// Triangles of one material: index_count / 3 of them in Scene::indices from first_index. Each index is
/// relative to Scene::vertices[0].
struct Primitive {
    uint32_t first_index = 0;
    uint32_t index_count = 0;
    uint32_t material = 0;  ///< index into Scene::materials
};

struct Mesh {
    std::string name = {};
    std::vector<Primitive> primitives = {};
};

/// A mesh placed in the world.
struct Instance {
    uint32_t mesh = 0;               ///< index into Scene::meshes
    glm::mat4 world_from_object{1};  ///< affine, invertible; negative determinants (mirrors) are allowed
};

enum class LightKind : uint8_t { directional, point, spot };

/// An analytic light, KHR_lights_punctual.
struct Light {
    std::string name = {};
    LightKind kind = LightKind::directional;
    /// Directional: irradiance on a facing plane, W/m²; point and spot: radiant intensity, W/sr.
    glm::vec3 intensity{0};
    glm::vec3 position{0};          ///< world; point and spot
    glm::vec3 direction{0, -1, 0};  ///< world, unit length, the way the light travels; directional and spot
    float range = 0;                ///< metres; 0 is unbounded
    float inner_cone_angle = 0;     ///< radians, from the axis
    float outer_cone_angle = 0.785398f;
};

/// A pinhole camera.
struct Camera {
    std::string name = {};
    glm::vec3 position{0};
    glm::vec3 target{0, 0, -1};                     ///< a point on the optical axis
    glm::vec3 up{0, 1, 0};                          ///< not parallel to the axis
    float vertical_fov = 0.785398f;                 ///< radians
    float near_plane = 0.05f;                       ///< metres
    float far_plane = 1000;                         ///< metres; the loader makes it finite
    std::optional<float> orthographic_height = {};  ///< metres; set for an orthographic camera
};

/// What lies beyond the scene: scene/sky.hpp says where.
struct Sky {
    Atmosphere atmosphere = earth();
    glm::vec3 direction_to_sun{0, 1, 0};  ///< unit length
    double altitude_km = 0;               ///< of the world's origin above the planet's ground, 0 and up
};

/// Everything that a frame may need. Indices between its parts are valid by construction.
struct Scene {
    std::string name = {};
    std::vector<Vertex> vertices = {};
    std::vector<uint32_t> indices = {};
    std::vector<Mesh> meshes = {};
    std::vector<Instance> instances = {};
    std::vector<Material> materials = {};  ///< at least one where there is a primitive
    std::vector<Texture> textures = {};
    std::vector<Image8> images = {};
    std::vector<Light> lights = {};
    std::vector<Camera> cameras = {};
    glm::vec3 environment_radiance{0};  ///< W/m²/sr from everywhere outside the geometry
    /// What the path tracer takes for the sky: radiance from outside the geometry beside environment_radiance, W/m²/sr,
    /// three channels. Rows from +Y to -Y, columns from +X over +Z, both by equal angles; empty for none.
    ImageF environment_map = {};
    std::optional<Sky> sky = {};             ///< its sun is among the lights (set_sky)
    std::vector<std::string> warnings = {};  ///< what the file uses and lumo does not do, one line each

    uint64_t triangle_count() const;  ///< instances counted each
};

/// World bounds of all instances; empty for a scene without triangles. Exact up to 2^28 corners of triangles
/// in instances that are turned, beyond that never too small.
Bounds world_bounds(const Scene& scene);

/// The camera that is used when none is asked for: the scene's first; else, in a scene that closes around its middle
/// like a room, one that looks along it from within; else one that sees all of its bounds.
Camera default_camera(const Scene& scene);

/// Whether anything shines: a light of any kind, an emitter on an instance, or the environment.
bool has_light(const Scene& scene);

/// A sun from steeply above, so that it also reaches the floor of a narrow court, and a sky: for a scene without light.
void add_daylight(Scene& scene);

}  // namespace lumo::scene
