#include "scene/builtin/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace lumo::scene::builtin {

namespace {

constexpr float min_double_area = 1e-7f;  // m²; what is smaller is a pole or a closed end

void add_triangle(Geometry& geometry, uint32_t a, uint32_t b, uint32_t c) {
    const glm::vec3 p = geometry.vertices[a].position;
    const glm::vec3 area = glm::cross(geometry.vertices[b].position - p, geometry.vertices[c].position - p);
    if (glm::dot(area, area) < min_double_area * min_double_area) return;
    geometry.indices.insert(geometry.indices.end(), {a, b, c});
}

glm::vec4 tangent_beside(glm::vec3 normal, glm::vec3 along) {
    return glm::vec4(glm::normalize(along - normal * glm::dot(normal, along)), 1);
}

/// A profile's points with the normals and lengths they are swept with; a sharp corner appears twice.
struct ProfileColumn {
    glm::vec2 point;
    glm::vec2 normal;
    float length;
    bool joined;  ///< a face lies between this column and the next
};

std::vector<ProfileColumn> columns_of(const Profile& profile) {
    const auto& p = profile.points;
    const auto edge_normal = [&](size_t i) {
        const glm::vec2 d = p[i + 1] - p[i];
        return glm::normalize(glm::vec2(d.y, -d.x));
    };
    const float smooth_above = std::cos(profile.crease_angle);
    std::vector<ProfileColumn> columns;
    float length = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        if (i > 0) length += glm::distance(p[i - 1], p[i]);
        if (i == 0 || i + 1 == p.size()) {
            columns.push_back({p[i], edge_normal(i == 0 ? 0 : i - 1), length, i == 0});
            continue;
        }
        const glm::vec2 before = edge_normal(i - 1), after = edge_normal(i);
        if (glm::dot(before, after) > smooth_above) {
            columns.push_back({p[i], glm::normalize(before + after), length, true});
        } else {
            columns.push_back({p[i], before, length, false});
            columns.push_back({p[i], after, length, true});
        }
    }
    return columns;
}

}  // namespace

Geometry& Model::operator[](const Finish& finish) {
    const auto found = std::ranges::find(parts_, finish, &std::pair<Finish, Geometry>::first);
    if (found != parts_.end()) return found->second;
    return parts_.emplace_back(finish, Geometry{}).second;
}

void append(Geometry& to, const Geometry& from, const glm::mat4& placement) {
    const glm::mat3 linear(placement);
    const glm::mat3 normal_matrix = glm::transpose(glm::inverse(linear));
    const bool mirrored = glm::determinant(linear) < 0;
    const auto base = uint32_t(to.vertices.size());
    for (Vertex vertex : from.vertices) {
        vertex.position = glm::vec3(placement * glm::vec4(vertex.position, 1));
        vertex.normal = glm::normalize(normal_matrix * vertex.normal);
        const float handedness = mirrored ? -vertex.tangent.w : vertex.tangent.w;
        vertex.tangent = glm::vec4(
            glm::vec3(tangent_beside(vertex.normal, linear * glm::vec3(vertex.tangent))), handedness);
        to.vertices.push_back(vertex);
    }
    for (size_t i = 0; i + 2 < from.indices.size(); i += 3) {
        to.indices.push_back(base + from.indices[i]);
        to.indices.push_back(base + from.indices[mirrored ? i + 2 : i + 1]);
        to.indices.push_back(base + from.indices[mirrored ? i + 1 : i + 2]);
    }
}

Geometry reversed(Geometry geometry) {
    for (Vertex& vertex : geometry.vertices) {
        vertex.normal = -vertex.normal;
        vertex.tangent.w = -vertex.tangent.w;
    }
    for (size_t i = 0; i < geometry.indices.size(); i += 3) {
        std::swap(geometry.indices[i + 1], geometry.indices[i + 2]);
    }
    return geometry;
}

void append(Model& to, const Model& from, const glm::mat4& placement) {
    for (const auto& [finish, geometry] : from.parts()) append(to[finish], geometry, placement);
}

uint32_t add_mesh(Scene& scene, std::string name, const Model& model) {
    Mesh mesh{.name = std::move(name)};
    for (const auto& [finish, geometry] : model.parts()) {
        const auto base = uint32_t(scene.vertices.size());
        mesh.primitives.push_back({.first_index = uint32_t(scene.indices.size()),
                                   .index_count = uint32_t(geometry.indices.size()),
                                   .material = finish.material});
        for (Vertex vertex : geometry.vertices) {
            vertex.uv0 /= finish.metres_per_tile;
            scene.vertices.push_back(vertex);
        }
        for (const uint32_t index : geometry.indices) scene.indices.push_back(base + index);
    }
    scene.meshes.push_back(std::move(mesh));
    return uint32_t(scene.meshes.size() - 1);
}

uint32_t add_diffuse_material(Scene& scene, std::string name, glm::vec3 albedo) {
    scene.materials.push_back({.name = std::move(name), .base_color = glm::vec4(albedo, 1), .metallic = 0});
    return uint32_t(scene.materials.size() - 1);
}

glm::mat4 translation(glm::vec3 offset) { return glm::translate(glm::mat4(1), offset); }

glm::mat4 rotation_y(float radians) { return glm::rotate(glm::mat4(1), radians, glm::vec3(0, 1, 0)); }

Geometry parallelogram(glm::vec3 origin, glm::vec3 right, glm::vec3 up) {
    return quadrilateral(origin, origin + right, origin + right + up, origin + up);
}

Geometry quadrilateral(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const glm::vec3 normal = glm::normalize(glm::cross(c - a, d - b));
    const glm::vec4 tangent = tangent_beside(normal, b - a);
    const glm::vec3 up = glm::cross(normal, glm::vec3(tangent));
    Geometry result;
    for (const glm::vec3 p : {a, b, c, d}) {
        result.vertices.push_back({.position = p,
                                   .normal = normal,
                                   .tangent = tangent,
                                   .uv0 = {glm::dot(p - a, glm::vec3(tangent)), -glm::dot(p - a, up)}});
    }
    add_triangle(result, 0, 1, 2);
    add_triangle(result, 0, 2, 3);
    return result;
}

Geometry box(glm::vec3 min, glm::vec3 max) {
    Geometry result;
    const glm::vec3 size = max - min;
    const auto add_face = [&](glm::vec3 origin, glm::vec3 right, glm::vec3 up) {
        Geometry face = parallelogram(origin, right, up);
        for (Vertex& vertex : face.vertices) {
            vertex.uv0 = {glm::dot(vertex.position, glm::normalize(right)),
                          -glm::dot(vertex.position, glm::normalize(up))};
        }
        append(result, face);
    };
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    add_face(min + z, x, y);
    add_face(min + x, -x, y);
    add_face(min + x + z, -z, y);
    add_face(min, z, y);
    add_face(min + y + z, x, -z);
    add_face(min, x, z);
    for (Vertex& vertex : result.vertices) vertex.position = glm::clamp(vertex.position, min, max);
    return result;
}

Geometry block(const std::array<glm::vec3, 4>& lower, const std::array<glm::vec3, 4>& upper) {
    Geometry result;
    append(result, quadrilateral(upper[0], upper[1], upper[2], upper[3]));
    append(result, quadrilateral(lower[3], lower[2], lower[1], lower[0]));
    for (size_t i = 0; i < 4; ++i) {
        const size_t next = (i + 1) % 4;
        append(result, quadrilateral(lower[i], lower[next], upper[next], upper[i]));
    }
    return result;
}

Geometry grid(const GridShape& shape, const std::function<glm::vec3(float, float)>& position) {
    // Taken a step inside the border, where an edge that has shrunk to a point still has a direction.
    constexpr float step = 1e-3f;
    const auto derivative = [&](float s, float t, glm::vec2 direction) {
        const glm::vec2 inside = glm::clamp(glm::vec2(s, t), step, 1 - step);
        const glm::vec2 low = inside - step * direction, high = inside + step * direction;
        return position(high.x, high.y) - position(low.x, low.y);
    };
    Geometry result;
    for (uint32_t row = 0; row <= shape.rows; ++row) {
        for (uint32_t column = 0; column <= shape.columns; ++column) {
            const float s = float(column) / float(shape.columns), t = float(row) / float(shape.rows);
            const glm::vec3 right = derivative(s, t, {1, 0}), up = derivative(s, t, {0, 1});
            const glm::vec3 normal = glm::normalize(glm::cross(right, up));
            result.vertices.push_back({.position = position(s, t),
                                       .normal = normal,
                                       .tangent = tangent_beside(normal, right),
                                       .uv0 = {s * shape.metres.x, -t * shape.metres.y}});
        }
    }
    for (uint32_t row = 0; row < shape.rows; ++row) {
        for (uint32_t column = 0; column < shape.columns; ++column) {
            const uint32_t a = row * (shape.columns + 1) + column, b = a + shape.columns + 1;
            add_triangle(result, a, a + 1, b + 1);
            add_triangle(result, a, b + 1, b);
        }
    }
    return result;
}

std::vector<glm::vec2> arc(glm::vec2 center, glm::vec2 radii, float from, float to, uint32_t segments) {
    std::vector<glm::vec2> points;
    for (uint32_t i = 0; i <= segments; ++i) {
        const float angle = from + (to - from) * float(i) / float(segments);
        points.push_back(center + radii * glm::vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

Geometry sweep(const Profile& profile, std::span<const SweepFrame> frames) {
    const std::vector<ProfileColumn> columns = columns_of(profile);
    Geometry result;
    for (const SweepFrame& frame : frames) {
        const glm::vec3 along = glm::cross(frame.y_axis, frame.x_axis);
        for (const ProfileColumn& column : columns) {
            const float sheared = column.point.x * frame.shear;
            result.vertices.push_back(
                {.position = frame.origin + column.point.x * frame.x_axis + column.point.y * frame.y_axis +
                             sheared * along,
                 .normal = glm::normalize(column.normal.x * frame.x_axis + column.normal.y * frame.y_axis),
                 .tangent = glm::vec4(along, 1),
                 .uv0 = {frame.u + sheared, -column.length}});
        }
    }
    const auto count = uint32_t(columns.size());
    for (uint32_t frame = 0; frame + 1 < frames.size(); ++frame) {
        for (uint32_t column = 0; column + 1 < count; ++column) {
            if (!columns[column].joined) continue;
            const uint32_t a = frame * count + column, b = a + count;
            add_triangle(result, a, b, b + 1);
            add_triangle(result, a, b + 1, a + 1);
        }
    }
    return result;
}

Geometry lathe(const Profile& profile, uint32_t segments) {
    float girth = 0;
    for (const glm::vec2 p : profile.points) girth = std::max(girth, p.x);
    std::vector<SweepFrame> frames;
    for (uint32_t i = 0; i <= segments; ++i) {
        // The last frame takes the first one's angle, so that the solid closes to the bit.
        const float angle = glm::two_pi<float>() * float(i % segments) / float(segments);
        frames.push_back({.x_axis = {std::sin(angle), 0, std::cos(angle)},
                          .u = glm::two_pi<float>() * girth * float(i) / float(segments)});
    }
    return sweep(profile, frames);
}

Geometry prism(const Profile& profile, uint32_t sides) {
    Geometry result;
    const float half_angle = glm::pi<float>() / float(sides);
    for (uint32_t i = 0; i < sides; ++i) {
        const float angle = 2 * half_angle * float(i);
        const glm::vec3 outward(std::sin(angle), 0, std::cos(angle));
        const std::array frames{SweepFrame{.x_axis = outward, .shear = -std::tan(half_angle)},
                                SweepFrame{.x_axis = outward, .shear = std::tan(half_angle)}};
        append(result, sweep(profile, frames));
    }
    return result;
}

Geometry moulding(const Profile& profile, float length, float mitre_start, float mitre_end) {
    const std::array frames{SweepFrame{.shear = mitre_start},
                            SweepFrame{.origin = {length, 0, 0}, .u = length, .shear = -mitre_end}};
    return sweep(profile, frames);
}

Geometry archivolt(const Profile& profile, glm::vec2 radii, uint32_t segments) {
    std::vector<SweepFrame> frames;
    float u = 0;
    for (uint32_t i = 0; i <= segments; ++i) {
        const float angle = glm::pi<float>() * (1 - float(i) / float(segments));
        const glm::vec2 unit(i == segments ? 1 : std::cos(angle),
                             i == 0 || i == segments ? 0 : std::sin(angle));
        const glm::vec3 origin(radii * unit, 0);
        if (i > 0) u += glm::distance(origin, frames.back().origin);
        frames.push_back({.origin = origin,
                          .x_axis = {0, 0, 1},
                          .y_axis = glm::vec3(glm::normalize(unit / radii), 0),
                          .u = u});
    }
    return sweep(profile, frames);
}

Geometry sphere(float radius, uint32_t segments, uint32_t rings) {
    Profile profile{arc({0, 0}, glm::vec2(radius), -glm::half_pi<float>(), glm::half_pi<float>(), rings)};
    profile.points.front() = {0, -radius};
    profile.points.back() = {0, radius};
    Geometry result = lathe(profile, segments);
    for (Vertex& vertex : result.vertices) vertex.normal = vertex.position / radius;
    return result;
}

Geometry faceted_sphere(float radius, uint32_t segments, uint32_t rings) {
    const Geometry smooth = sphere(radius, segments, rings);
    Geometry result;
    for (size_t i = 0; i < smooth.indices.size(); i += 3) {
        const Vertex* corners[3];
        for (size_t k = 0; k < 3; ++k) corners[k] = &smooth.vertices[smooth.indices[i + k]];
        const glm::vec3 normal = glm::normalize(glm::cross(corners[1]->position - corners[0]->position,
                                                           corners[2]->position - corners[0]->position));
        for (const Vertex* corner : corners) {
            Vertex vertex = *corner;
            vertex.normal = normal;
            vertex.tangent = tangent_beside(normal, glm::vec3(vertex.tangent));
            result.indices.push_back(uint32_t(result.vertices.size()));
            result.vertices.push_back(vertex);
        }
    }
    return result;
}

}  // namespace lumo::scene::builtin
