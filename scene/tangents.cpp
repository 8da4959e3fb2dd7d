#include "scene/tangents.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <deque>
#include <numeric>
#include <tuple>
#include <utility>

namespace lumo::scene {
namespace {

constexpr uint32_t none = ~0u;

// Position, normal and uv, whose v points up as a normal map's y does (glTF's v points down).
struct Corner {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec2 uv;

    // Bits, because they are in order even where a coordinate overflowed.
    std::array<uint32_t, 8> key() const {
        return std::bit_cast<std::array<uint32_t, 8>>(
            std::array{position.x, position.y, position.z, normal.x, normal.y, normal.z, uv.x, uv.y});
    }
};

struct Face {
    glm::vec3 du{0};          // direction in which u grows
    bool preserves = false;   // the uv orientation
    bool any_group = true;    // without a usable uv gradient: joins any group, begins none
    bool degenerate = false;  // without area
    std::array<uint32_t, 3> neighbor{none, none, none};  // across the edge from corner i to corner i + 1
    std::array<uint32_t, 3> group{none, none, none};     // of corner i
};

struct Group {
    uint32_t vertex = 0;
    bool preserves = false;
    glm::vec3 sum{0};
};

bool is_zero(float x) { return std::abs(x) <= FLT_MIN; }
glm::vec3 normalize_or_zero(glm::vec3 v) {
    const float length = glm::length(v);
    return is_zero(length) ? glm::vec3(0) : v / length;
}
glm::vec3 in_plane(glm::vec3 v, glm::vec3 normal) {
    return normalize_or_zero(v - glm::dot(normal, v) * normal);
}

glm::vec3 any_perpendicular(glm::vec3 normal) {
    const glm::vec3 axis = std::abs(normal.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    return glm::normalize(axis - glm::dot(normal, axis) * normal);
}

std::vector<Corner> make_corners(std::span<const Vertex> vertices, const TangentUv& uv) {
    std::vector<Corner> corners(vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i) {
        const Vertex& v = vertices[i];
        const glm::vec2 texture = uv.uv_transform * glm::vec3(uv.uv_set == 0 ? v.uv0 : v.uv1, 1);
        // Adding zero makes negative zeros equal to the others.
        corners[i] = {v.position + 0.0f, v.normal + 0.0f, glm::vec2(texture.x, -texture.y) + 0.0f};
    }
    return corners;
}

// For each vertex the first in sorted order that equals it.
std::vector<uint32_t> weld(std::span<const Corner> corners) {
    std::vector<uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
        const auto key_a = corners[a].key(), key_b = corners[b].key();
        return key_a != key_b ? key_a < key_b : a < b;
    });
    std::vector<uint32_t> welded(corners.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && corners[order[i]].key() == corners[order[i - 1]].key();
        welded[order[i]] = same ? welded[order[i - 1]] : order[i];
    }
    return welded;
}

Face make_face(const Corner& a, const Corner& b, const Corner& c) {
    Face face;
    face.degenerate = a.position == b.position || a.position == c.position || b.position == c.position;
    const glm::vec3 d1 = b.position - a.position, d2 = c.position - a.position;
    const glm::vec2 t1 = b.uv - a.uv, t2 = c.uv - a.uv;
    const float area = t1.x * t2.y - t1.y * t2.x;
    const glm::vec3 du = t2.y * d1 - t1.y * d2;
    const glm::vec3 dv = t1.x * d2 - t2.x * d1;
    face.preserves = area > 0;
    if (!is_zero(area)) {
        face.du = normalize_or_zero(du) * (face.preserves ? 1.0f : -1.0f);
        face.any_group = is_zero(glm::length(du) / area) || is_zero(glm::length(dv) / area);
    }
    return face;
}

// Pairs the triangles on both sides of an edge that run along it in opposite directions.
void find_neighbors(std::vector<Face>& faces, std::span<const uint32_t> ids) {
    struct Edge {
        uint32_t low, high, corner;  // the corner that it starts from
        bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(ids.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate) continue;
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t from = ids[3 * f + i], to = ids[3 * f + (i + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), 3 * f + i, from < to});
        }
    }
    std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
    });
    std::deque<Edge> open;  // of one edge, all in the same direction
    for (const Edge& edge : edges) {
        if (!open.empty() && (open.front().low != edge.low || open.front().high != edge.high)) open.clear();
        if (open.empty() || open.front().forward == edge.forward) {
            open.push_back(edge);
            continue;
        }
        const uint32_t other = open.front().corner;
        open.pop_front();
        faces[edge.corner / 3].neighbor[edge.corner % 3] = other / 3;
        faces[other / 3].neighbor[other % 3] = edge.corner / 3;
    }
}

uint32_t corner_of(std::span<const uint32_t> ids, uint32_t face, uint32_t vertex) {
    const uint32_t* id = ids.data() + 3 * size_t(face);
    return id[0] == vertex ? 0 : id[1] == vertex ? 1 : 2;
}

std::vector<Group> make_groups(std::vector<Face>& faces, std::span<const uint32_t> ids) {
    std::vector<Group> groups;
    std::vector<uint32_t> open;
    for (uint32_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate || faces[f].any_group) continue;
        for (uint32_t i = 0; i < 3; ++i) {
            if (faces[f].group[i] != none) continue;
            const uint32_t index = uint32_t(groups.size());
            const Group group{ids[3 * f + i], faces[f].preserves};
            groups.push_back(group);
            open.assign(1, f);
            while (!open.empty()) {
                const uint32_t current = open.back();
                open.pop_back();
                Face& face = faces[current];
                const uint32_t corner = corner_of(ids, current, group.vertex);
                if (face.group[corner] != none) continue;
                // The first group to reach a triangle without uv area decides its orientation.
                const bool untouched = face.group == std::array<uint32_t, 3>{none, none, none};
                if (face.any_group && untouched) face.preserves = group.preserves;
                if (face.preserves != group.preserves) continue;
                face.group[corner] = index;
                const uint32_t left = face.neighbor[corner], right = face.neighbor[(corner + 2) % 3];
                if (right != none) open.push_back(right);
                if (left != none) open.push_back(left);
            }
        }
    }
    return groups;
}

void add_to_groups(std::vector<Group>& groups, std::span<const Face> faces, std::span<const Corner> corners,
                   std::span<const uint32_t> ids) {
    for (uint32_t f = 0; f < faces.size(); ++f) {
        const Face& face = faces[f];
        if (face.any_group) continue;
        for (uint32_t i = 0; i < 3; ++i) {
            if (face.group[i] == none) continue;
            const Corner& here = corners[ids[3 * f + i]];
            const auto edge_to = [&](uint32_t j) {
                return in_plane(corners[ids[3 * f + j]].position - here.position, here.normal);
            };
            const float cosine = glm::dot(edge_to((i + 1) % 3), edge_to((i + 2) % 3));
            const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f));
            groups[face.group[i]].sum += angle * in_plane(face.du, here.normal);
        }
    }
}

}  // namespace

std::vector<glm::vec4> corner_tangents(std::span<const Vertex> vertices, std::span<const uint32_t> indices,
                                       const TangentUv& uv) {
    const std::vector<Corner> corners = make_corners(vertices, uv);
    const std::vector<uint32_t> welded = weld(corners);
    std::vector<uint32_t> ids(indices.size());
    std::ranges::transform(indices, ids.begin(), [&](uint32_t index) { return welded[index]; });
    std::vector<Face> faces(indices.size() / 3);
    for (size_t f = 0; f < faces.size(); ++f)
        faces[f] = make_face(corners[ids[3 * f]], corners[ids[3 * f + 1]], corners[ids[3 * f + 2]]);

    find_neighbors(faces, ids);
    std::vector<Group> groups = make_groups(faces, ids);
    add_to_groups(groups, faces, corners, ids);

    // A triangle without area takes what another at the same vertex has.
    std::vector<uint32_t> group_at(vertices.size(), none);
    for (size_t k = 0; k < ids.size(); ++k) {
        const uint32_t group = faces[k / 3].group[k % 3];
        if (group != none && group_at[ids[k]] == none) group_at[ids[k]] = group;
    }
    std::vector<glm::vec4> tangents(indices.size());
    for (size_t k = 0; k < ids.size(); ++k) {
        const Face& face = faces[k / 3];
        const uint32_t group = face.degenerate ? group_at[ids[k]] : face.group[k % 3];
        const glm::vec3 sum = group == none ? glm::vec3(0) : groups[group].sum;
        const bool preserves = group == none || groups[group].preserves;
        const glm::vec3 unit = glm::normalize(sum);
        const bool is_unit = std::abs(glm::length(unit) - 1) < 1e-3f;
        const glm::vec3 direction = is_unit ? unit : any_perpendicular(corners[ids[k]].normal);
        tangents[k] = glm::vec4(direction, preserves ? 1 : -1);
    }
    return tangents;
}

void generate_tangents(std::vector<Vertex>& vertices, std::vector<uint32_t>& indices, const TangentUv& uv) {
    const std::vector<glm::vec4> tangents = corner_tangents(vertices, indices, uv);
    const auto key = [&](uint32_t k) {
        const auto bits = std::bit_cast<std::array<uint32_t, 4>>(tangents[k]);
        return std::pair(indices[k], bits);
    };
    std::vector<uint32_t> order(indices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](uint32_t a, uint32_t b) { return key(a) < key(b); });

    std::vector<Vertex> split;
    std::vector<uint32_t> remapped(indices.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const uint32_t k = order[i];
        if (i == 0 || key(order[i - 1]) != key(k)) {
            split.push_back(vertices[indices[k]]);
            split.back().tangent = tangents[k];
        }
        remapped[k] = uint32_t(split.size() - 1);
    }
    vertices = std::move(split);
    indices = std::move(remapped);
}

}  // namespace lumo::scene
