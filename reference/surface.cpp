#include "reference/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lumo::reference {
namespace {

using scene::Filter;
using scene::Wrap;

enum class Encoding : uint8_t { linear, srgb };

const std::array<double, 256>& decoded_srgb_bytes() {
    static const std::array<double, 256> table = [] {
        std::array<double, 256> values{};
        for (int i = 0; i < 256; ++i) {
            const double v = i / 255.0;
            values[size_t(i)] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        }
        return values;
    }();
    return table;
}

uint32_t wrapped(int64_t i, uint32_t size, Wrap wrap) {
    const int64_t n = size;
    if (wrap == Wrap::clamp_to_edge) return uint32_t(std::clamp<int64_t>(i, 0, n - 1));
    const int64_t period = wrap == Wrap::repeat ? n : 2 * n;
    const int64_t in_period = (i % period + period) % period;
    return uint32_t(in_period < n ? in_period : 2 * n - 1 - in_period);
}

glm::dvec4 texel(const scene::Image8& image, uint32_t x, uint32_t y, Encoding encoding) {
    glm::dvec4 value(0, 0, 0, 1);
    const uint8_t* bytes = image.at(x, y);
    for (int c = 0; c < int(std::min(image.channels, 4u)); ++c)
        value[c] = encoding == Encoding::srgb && c < 3 ? decoded_srgb_bytes()[bytes[c]] : bytes[c] / 255.0;
    return value;
}

glm::dvec4 sampled(const scene::Scene& scene, const scene::TextureSlot& slot,
                   const std::array<glm::dvec2, 2>& uv_sets, Encoding encoding) {
    const scene::Texture& texture = scene.textures[slot.texture];
    const scene::Image8& image = scene.images[texture.image];
    const scene::TextureSampler& sampler = texture.sampler;
    // Far from the origin a coordinate says nothing about a texel any more.
    constexpr double farthest = 1e9;
    const glm::dvec2 uv = glm::clamp(
        glm::dvec2(glm::dmat3(slot.uv_transform) * glm::dvec3(uv_sets[slot.uv_set], 1)), -farthest, farthest);
    const glm::dvec2 at = uv * glm::dvec2(image.width, image.height);
    const auto read = [&](double x, double y) {
        return texel(image, wrapped(int64_t(x), image.width, sampler.wrap_u),
                     wrapped(int64_t(y), image.height, sampler.wrap_v), encoding);
    };
    if (sampler.magnification == Filter::nearest) return read(std::floor(at.x), std::floor(at.y));
    const glm::dvec2 corner = glm::floor(at - 0.5);
    const glm::dvec2 f = at - 0.5 - corner;
    return glm::mix(glm::mix(read(corner.x, corner.y), read(corner.x + 1, corner.y), f.x),
                    glm::mix(read(corner.x, corner.y + 1), read(corner.x + 1, corner.y + 1), f.x), f.y);
}

/// The three vertices of a triangle and the weights of a point among them.
struct Corners {
    std::array<const scene::Vertex*, 3> vertices;
    glm::dvec3 weights;

    template <class T>
    auto interpolated(T scene::Vertex::*member) const {
        using Double =
            std::conditional_t<std::is_same_v<T, glm::vec2>, glm::dvec2,
                               std::conditional_t<std::is_same_v<T, glm::vec3>, glm::dvec3, glm::dvec4>>;
        return weights.x * Double(vertices[0]->*member) + weights.y * Double(vertices[1]->*member) +
               weights.z * Double(vertices[2]->*member);
    }
    std::array<glm::dvec2, 2> uv_sets() const {
        return {interpolated(&scene::Vertex::uv0), interpolated(&scene::Vertex::uv1)};
    }
};

Corners corners_of(const scene::Scene& scene, const scene::Primitive& primitive, uint32_t triangle,
                   glm::dvec2 weights) {
    const uint32_t* index = scene.indices.data() + primitive.first_index + 3 * size_t(triangle);
    const auto vertex = [&](int i) { return &scene.vertices[index[i]]; };
    return {{vertex(0), vertex(1), vertex(2)}, {1 - weights.x - weights.y, weights.x, weights.y}};
}

glm::dvec4 base_color(const scene::Scene& scene, const scene::Material& material, const Corners& corners,
                      const std::array<glm::dvec2, 2>& uv_sets) {
    glm::dvec4 color = glm::dvec4(material.base_color) * corners.interpolated(&scene::Vertex::color);
    if (material.base_color_texture)
        color *= sampled(scene, *material.base_color_texture, uv_sets, Encoding::srgb);
    return color;
}

glm::dvec3 emission(const scene::Scene& scene, const scene::Material& material,
                    const std::array<glm::dvec2, 2>& uv_sets) {
    glm::dvec3 radiance(material.emission);
    if (material.emits() && material.emission_texture)
        radiance *= glm::dvec3(sampled(scene, *material.emission_texture, uv_sets, Encoding::srgb));
    return radiance;
}

const scene::Instance& instance_of(const scene::Scene& scene, const Hit& hit) {
    return scene.instances[hit.instance];
}

const scene::Primitive& primitive_of(const scene::Scene& scene, const Hit& hit) {
    return scene.meshes[instance_of(scene, hit).mesh].primitives[hit.primitive];
}

/// -1 for an instance that mirrors, which swaps the order of corners, else 1.
double handedness(const glm::dmat4& world_from_object) {
    return glm::determinant(glm::dmat3(world_from_object)) < 0 ? -1 : 1;
}

WorldTriangle placed(const Corners& corners, const glm::dmat4& world_from_object) {
    WorldTriangle triangle;
    for (size_t i = 0; i < 3; ++i)
        triangle.corners[i] = glm::dvec3(world_from_object * glm::dvec4(corners.vertices[i]->position, 1));
    const auto& [a, b, c] = triangle.corners;
    triangle.normal = handedness(world_from_object) * glm::cross(b - a, c - a);
    return triangle;
}

double largest(glm::dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

glm::dvec3 unit_or(glm::dvec3 v, glm::dvec3 otherwise) {
    const double length = glm::length(v);
    return length > 1e-12 ? v / length : otherwise;
}

/// In world space, as vertex shaders hand them on: unit length at the vertices alone.
struct TangentFrame {
    glm::dvec3 normal{0};
    glm::dvec4 tangent{0};
};

TangentFrame tangent_frame(const Corners& corners, const glm::dmat3& world_from_direction,
                           const glm::dmat3& world_from_normal, double bitangent_sign) {
    TangentFrame frame;
    for (int i = 0; i < 3; ++i) {
        const scene::Vertex& vertex = *corners.vertices[size_t(i)];
        const glm::dvec3 normal = unit_or(world_from_normal * glm::dvec3(vertex.normal), glm::dvec3(0));
        const glm::dvec3 tangent = unit_or(world_from_direction * glm::dvec3(vertex.tangent), glm::dvec3(0));
        frame.normal += corners.weights[i] * normal;
        frame.tangent += corners.weights[i] * glm::dvec4(tangent, double(vertex.tangent.w) * bitangent_sign);
    }
    return frame;
}

glm::dvec3 mapped_normal(const scene::Scene& scene, const scene::Material& material,
                         const std::array<glm::dvec2, 2>& uv_sets, const TangentFrame& frame) {
    const glm::dvec3 stored(sampled(scene, *material.normal_texture, uv_sets, Encoding::linear));
    const glm::dvec3 t = 2.0 * stored - 1.0;
    const glm::dvec3 tangent(frame.tangent);
    const glm::dvec3 bitangent = frame.tangent.w * glm::cross(frame.normal, tangent);
    return t.x * double(material.normal_scale) * tangent + t.y * double(material.normal_scale) * bitangent +
           std::max(t.z, 1e-2) * frame.normal;
}

Brdf brdf_of(const scene::Scene& scene, const scene::Material& material,
             const std::array<glm::dvec2, 2>& uv_sets, glm::dvec3 base) {
    double metallic = double(material.metallic), roughness = double(material.roughness);
    if (material.metallic_roughness_texture) {
        const glm::dvec4 stored =
            sampled(scene, *material.metallic_roughness_texture, uv_sets, Encoding::linear);
        roughness *= stored.g;
        metallic *= stored.b;
    }
    return make_brdf(base, metallic, roughness);
}

}  // namespace

double opacity_at(const scene::Scene& scene, const scene::Primitive& primitive, uint32_t triangle,
                  glm::dvec2 weights) {
    const scene::Material& material = scene.materials[primitive.material];
    if (material.alpha_mode == scene::AlphaMode::opaque) return 1;
    const Corners corners = corners_of(scene, primitive, triangle, weights);
    const double alpha = base_color(scene, material, corners, corners.uv_sets()).a;
    if (material.alpha_mode == scene::AlphaMode::mask) return alpha < double(material.alpha_cutoff) ? 0 : 1;
    return std::clamp(alpha, 0.0, 1.0);
}

WorldTriangle world_triangle(const scene::Scene& scene, const Hit& hit) {
    return placed(corners_of(scene, primitive_of(scene, hit), hit.triangle, hit.weights),
                  glm::dmat4(instance_of(scene, hit).world_from_object));
}

// What a float ray is off at a triangle goes with the coordinates that it is made of.
double WorldTriangle::lift() const {
    return 4e-6 * std::max({largest(corners[0]), largest(corners[1]), largest(corners[2])});
}

glm::dvec3 emission_at(const scene::Scene& scene, const Hit& hit) {
    const scene::Primitive& primitive = primitive_of(scene, hit);
    return emission(scene, scene.materials[primitive.material],
                    corners_of(scene, primitive, hit.triangle, hit.weights).uv_sets());
}

SurfacePoint surface_at(const scene::Scene& scene, const Hit& hit, glm::dvec3 direction, bool diffuse) {
    const scene::Primitive& primitive = primitive_of(scene, hit);
    const scene::Material& material = scene.materials[primitive.material];
    const Corners corners = corners_of(scene, primitive, hit.triangle, hit.weights);
    const glm::dmat4 world_from_object(instance_of(scene, hit).world_from_object);
    const glm::dmat3 world_from_direction(world_from_object);
    const WorldTriangle triangle = placed(corners, world_from_object);
    const std::array<glm::dvec2, 2> uv_sets = corners.uv_sets();

    SurfacePoint point;
    point.unlit = material.unlit;
    point.position = corners.weights.x * triangle.corners[0] + corners.weights.y * triangle.corners[1] +
                     corners.weights.z * triangle.corners[2];
    point.lift = triangle.lift();
    const glm::dvec3 front = unit_or(triangle.normal, -glm::normalize(direction));
    point.front = glm::dot(front, direction) <= 0;
    const double side = point.front ? 1 : -1;
    point.geometric_normal = side * front;

    const TangentFrame frame =
        tangent_frame(corners, world_from_direction, glm::transpose(glm::inverse(world_from_direction)),
                      handedness(world_from_object));
    const bool mapped = material.normal_texture && !material.unlit && !diffuse;
    point.normal =
        side * unit_or(mapped ? mapped_normal(scene, material, uv_sets, frame) : frame.normal, front);

    point.base_color = glm::dvec3(base_color(scene, material, corners, uv_sets));
    if (point.front || material.double_sided) point.emission = emission(scene, material, uv_sets);
    point.brdf = diffuse ? lambertian(point.base_color) : brdf_of(scene, material, uv_sets, point.base_color);
    return point;
}

}  // namespace lumo::reference
