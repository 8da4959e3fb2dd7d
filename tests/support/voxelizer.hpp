// The voxelizer's definition once more, in double precision: which voxels the columns' centre lines meet, with what
// weight, and how sure that is; and, by cutting polygons instead, how much surface each voxel truly holds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::testing_support {

struct GridTriangle {
    std::array<glm::dvec3, 3> corners;  ///< grid space: voxel (i, j, k) covers [i, i+1) x …
    uint32_t material = 0;

    glm::dvec3 doubled_area() const { return glm::cross(corners[1] - corners[0], corners[2] - corners[0]); }
};

inline std::vector<GridTriangle> grid_triangles(const scene::Scene& scene, const voxels::Grid& grid) {
    std::vector<GridTriangle> triangles;
    for (const scene::Instance& instance : scene.instances)
        for (const scene::Primitive& primitive : scene.meshes[instance.mesh].primitives)
            for (uint32_t i = 0; i < primitive.index_count; i += 3) {
                GridTriangle triangle{.corners = {}, .material = primitive.material};
                for (uint32_t c = 0; c < 3; ++c) {
                    const glm::vec3 p = scene.vertices[scene.indices[primitive.first_index + i + c]].position;
                    const glm::dvec3 world(glm::dmat4(instance.world_from_object) *
                                           glm::dvec4(glm::dvec3(p), 1));
                    triangle.corners[c] = (world - glm::dvec3(grid.origin)) / double(grid.voxel_size);
                }
                triangles.push_back(triangle);
            }
    return triangles;
}

inline double total_area(const std::vector<GridTriangle>& triangles) {
    double sum = 0;
    for (const GridTriangle& t : triangles) sum += 0.5 * glm::length(t.doubled_area());
    return sum;
}

/// One number per voxel, x fastest.
template <class T>
struct VoxelMap {
    int side = 0;
    std::vector<T> values;

    explicit VoxelMap(uint32_t s, T value = {}) : side(int(s)), values(size_t(s) * s * s, value) {}
    bool contains(glm::ivec3 v) const {
        return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < side && v.y < side && v.z < side;
    }
    size_t index(glm::ivec3 v) const {
        return (size_t(v.z) * size_t(side) + size_t(v.y)) * size_t(side) + size_t(v.x);
    }
    // Not references, so that T can be bool.
    T get(glm::ivec3 v) const { return values[index(v)]; }
    void set(glm::ivec3 v, T value) { values[index(v)] = value; }
};

/// What a voxel's sums may be. Hits too near an edge or a face for float32 and a rasterizer's 1/256 of a pixel to
/// decide are in the upper bound alone. Weights are in 1/64 of a voxel's face.
struct VoxelSums {
    double least_weight = 0;
    double greatest_weight = 0;
    uint32_t least_hits = 0;
    uint32_t greatest_hits = 0;
};

inline VoxelMap<VoxelSums> voxelized_on_cpu(const std::vector<GridTriangle>& triangles, uint32_t side) {
    // Vertices are snapped to 1/256 of a pixel, which moves an edge by less than this.
    constexpr double edge_tolerance = 1.0 / 256;
    VoxelMap<VoxelSums> map(side);
    for (const GridTriangle& triangle : triangles) {
        for (int axis = 0; axis < 3; ++axis) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const glm::dvec3 normal = triangle.doubled_area();
            const double length = glm::length(normal);
            const double cosine = std::abs(normal[axis]) / length;
            if (!(cosine > 0.99e-4)) continue;
            const bool surely_drawn = cosine > 1.01e-4;
            const glm::dvec2 slope(-normal[u] / normal[axis], -normal[v] / normal[axis]);
            const double height_tolerance = 1e-3 + 1e-5 * (std::abs(slope.x) + std::abs(slope.y));

            double lowest = 1e30, highest = -1e30;
            for (const glm::dvec3& corner : triangle.corners) {
                lowest = std::min(lowest, corner[axis]);
                highest = std::max(highest, corner[axis]);
            }
            std::array<glm::dvec2, 3> p;
            for (size_t c = 0; c < 3; ++c) p[c] = {triangle.corners[c][u], triangle.corners[c][v]};
            if (normal[axis] < 0) std::swap(p[1], p[2]);
            const glm::dvec2 low = glm::min(p[0], glm::min(p[1], p[2])) - edge_tolerance;
            const glm::dvec2 high = glm::max(p[0], glm::max(p[1], p[2])) + edge_tolerance;
            const auto first = [&](double x) { return std::max(int(std::ceil(x - 0.5)), 0); };
            const auto last = [&](double x) { return std::min(int(std::floor(x - 0.5)), int(side) - 1); };
            for (int j = first(low.y); j <= last(high.y); ++j) {
                for (int i = first(low.x); i <= last(high.x); ++i) {
                    const glm::dvec2 center(i + 0.5, j + 0.5);
                    double inside = 1e30;  // distance to the nearest edge, negative outside
                    for (size_t c = 0; c < 3; ++c) {
                        const glm::dvec2 edge = p[(c + 1) % 3] - p[c], to = center - p[c];
                        inside = std::min(
                            inside, (edge.x * to.y - edge.y * to.x) / std::max(glm::length(edge), 1e-12));
                    }
                    if (inside < -edge_tolerance) continue;
                    const glm::dvec2 from_anchor =
                        center - glm::dvec2(triangle.corners[0][u], triangle.corners[0][v]);
                    const double height =
                        std::clamp(triangle.corners[0][axis] + glm::dot(slope, from_anchor), lowest, highest);
                    const int lower = int(std::floor(height - height_tolerance));
                    const int upper = int(std::floor(height + height_tolerance));
                    const bool sure = surely_drawn && inside > edge_tolerance && lower == upper;
                    for (int k = lower; k <= upper; ++k) {
                        glm::ivec3 voxel;
                        voxel[axis] = k, voxel[u] = i, voxel[v] = j;
                        if (!map.contains(voxel)) continue;
                        VoxelSums& sums = map.values[map.index(voxel)];
                        const double share = 64 * cosine + 0.5;
                        sums.greatest_weight += std::max(std::floor(share + 1e-3), 1.0);
                        sums.greatest_hits += 1;
                        if (!sure) continue;
                        sums.least_weight += std::max(std::floor(share - 1e-3), 1.0);
                        sums.least_hits += 1;
                    }
                }
            }
        }
    }
    return map;
}

/// The part of a polygon on one side of the plane coordinate = at.
inline std::vector<glm::dvec3> cut(const std::vector<glm::dvec3>& polygon, int axis, double at, bool above) {
    std::vector<glm::dvec3> kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = above ? a[axis] - at : at - a[axis];
        const double db = above ? b[axis] - at : at - b[axis];
        if (da >= 0) kept.push_back(a);
        if ((da < 0) != (db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

/// Surface in each voxel, in voxel faces. What lies in the face between two counts for the upper.
inline VoxelMap<double> area_by_clipping(const std::vector<GridTriangle>& triangles, uint32_t side) {
    VoxelMap<double> map(side);
    const auto split = [&](const auto& self, std::vector<glm::dvec3> polygon, int axis,
                           glm::ivec3 voxel) -> void {
        if (polygon.size() < 3) return;
        if (axis == 3) {
            glm::dvec3 doubled(0);
            for (size_t i = 2; i < polygon.size(); ++i)
                doubled += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
            if (map.contains(voxel)) map.values[map.index(voxel)] += 0.5 * glm::length(doubled);
            return;
        }
        double low = 1e30, high = -1e30;
        for (const glm::dvec3& p : polygon) {
            low = std::min(low, p[axis]);
            high = std::max(high, p[axis]);
        }
        int slab = int(std::floor(low));
        for (; slab + 1 < high; ++slab) {
            voxel[axis] = slab;
            self(self, cut(polygon, axis, slab + 1, false), axis + 1, voxel);
            polygon = cut(polygon, axis, slab + 1, true);
        }
        voxel[axis] = slab;
        self(self, std::move(polygon), axis + 1, voxel);
    };
    for (const GridTriangle& t : triangles)
        split(split, {t.corners.begin(), t.corners.end()}, 0, glm::ivec3(0));
    return map;
}

/// Every voxel that a walk from face to face through empty voxels reaches from `start`.
inline VoxelMap<bool> flooded(const VoxelMap<bool>& occupied, glm::ivec3 start) {
    VoxelMap<bool> reached(uint32_t(occupied.side), false);
    std::vector<glm::ivec3> open;
    const auto visit = [&](glm::ivec3 v) {
        if (!occupied.contains(v) || occupied.get(v) || reached.get(v)) return;
        reached.set(v, true);
        open.push_back(v);
    };
    visit(start);
    while (!open.empty()) {
        const glm::ivec3 v = open.back();
        open.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = v;
                next[axis] += step;
                visit(next);
            }
    }
    return reached;
}

}  // namespace lumo::testing_support
