// Voxelization against its definition in double precision and against polygons cut by voxels; and the property that
// the definition is for: no path from face to face through empty voxels crosses a surface.
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "scene/builtin/builtin.hpp"
#include "tests/support/voxelize_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using scene::builtin::Geometry;

struct VoxelizeTest : VoxelizerTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, VoxelizeTest, each_voxelizer, voxelizer_name);

glm::vec3 random_unit(std::mt19937& random) {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
}

/// A ball that is turned, so that nothing about it lies along the grid.
scene::Scene ball_scene() {
    scene::Scene scene;
    add(scene, scene::builtin::faceted_sphere(1, 40, 20), diffuse({0.8f, 0.4f, 0.2f}),
        glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 3))));
    return scene;
}

scene::Scene named_scene(const std::string& name) {
    return name == "ball" ? ball_scene() : without_textures(value_of(scene::make_builtin(name)));
}

constexpr uint32_t side = 64;

TEST_P(VoxelizeTest, OccupancyAndAreaAreTheDefinitions) {
    for (const std::string name : {"cornell", "ball", "atrium"}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = named_scene(name);
        const Voxelized voxelized = this->voxelized(scene, {.resolution = side});
        const VolumeTexels albedo = read_volume(device(), voxelized.volume.albedo());
        const VolumeTexels area = read_volume(device(), voxelized.volume.area());
        const auto triangles = grid_triangles(scene, voxelized.grid);
        const VoxelMap<VoxelSums> expected = voxelized_on_cpu(triangles, side);

        size_t occupied = 0, undecided = 0, wrong = 0, wrong_area = 0;
        for (size_t i = 0; i < albedo.texels.size(); ++i) {
            const VoxelSums& sums = expected.values[i];
            const bool here = albedo.texels[i].a > 0;
            occupied += here;
            undecided += sums.greatest_hits > 0 && sums.least_hits == 0;
            wrong += here ? sums.greatest_hits == 0 : sums.least_hits > 0;
            if (!here) continue;
            const auto encode = [](double weight) {
                return std::clamp(std::sqrt(weight / 64 / 16), 1.0 / 255, 1.0);
            };
            const double half_step = 0.5001 / 255;
            const double stored = double(area.texels[i].x);
            wrong_area += stored < encode(sums.least_weight) - half_step ||
                          stored > encode(sums.greatest_weight) + half_step;
        }
        EXPECT_EQ(wrong, 0u);
        EXPECT_EQ(wrong_area, 0u);
        // The comparison is worth its name: few voxels hang on rounding.
        EXPECT_LT(double(undecided), 0.02 * double(occupied));
        EXPECT_GT(occupied, 2000u);
    }
}

TEST_P(VoxelizeTest, OccupiedVoxelsHoldSurface) {
    for (const std::string name : {"cornell", "ball"}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = named_scene(name);
        const Voxelized voxelized = this->voxelized(scene, {.resolution = side});
        const VolumeTexels albedo = read_volume(device(), voxelized.volume.albedo());
        const VoxelMap<double> exact = area_by_clipping(grid_triangles(scene, voxelized.grid), side);
        size_t empty = 0, beside = 0;
        for (int z = 0; z < int(side); ++z)
            for (int y = 0; y < int(side); ++y)
                for (int x = 0; x < int(side); ++x) {
                    if (albedo.at({x, y, z}).a == 0 || exact.get({x, y, z}) > 0) continue;
                    ++empty;
                    // A surface in the face between two voxels may fall to either.
                    for (int axis = 0; axis < 3; ++axis) {
                        glm::ivec3 upper(x, y, z);
                        upper[axis] += 1;
                        if (exact.contains(upper) && exact.get(upper) > 0) {
                            ++beside;
                            break;
                        }
                    }
                }
        EXPECT_EQ(empty, beside);
        EXPECT_LE(empty, albedo.texels.size() / 1000);
    }
}

TEST_P(VoxelizeTest, AreaAndColourAreTheMeshsOnes) {
    for (const std::string name : {"cornell", "ball", "atrium"}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = named_scene(name);
        const Voxelized voxelized = this->voxelized(scene, {.resolution = side});
        const VolumeTexels albedo = read_volume(device(), voxelized.volume.albedo());
        const VolumeTexels area = read_volume(device(), voxelized.volume.area());
        const auto triangles = grid_triangles(scene, voxelized.grid);
        glm::dvec3 true_color(0), color(0);
        double true_area = 0, sum = 0;
        for (const GridTriangle& t : triangles) {
            const double a = 0.5 * glm::length(t.doubled_area());
            true_area += a;
            true_color += a * glm::dvec3(scene.materials[t.material].base_color);
        }
        for (size_t i = 0; i < albedo.texels.size(); ++i) {
            if (albedo.texels[i].a == 0) continue;
            const double a = decode_area(area.texels[i].x);
            sum += a;
            color += a * glm::dvec3(albedo.texels[i]);
        }
        // Details of the atrium that are much smaller than a voxel lie along the grid: centre lines meet all of a row
        // of them or none.
        EXPECT_NEAR(sum, true_area, (name == "atrium" ? 0.06 : 0.02) * true_area);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c] / sum, true_color[c] / true_area, 0.01);
    }
}

/// The polygon in which a plane through the middle of [-1, 1]³ cuts it, as a fan.
Geometry plane_through_cube(glm::vec3 normal, float offset) {
    std::vector<glm::dvec3> polygon;
    const glm::dvec3 n(normal);
    const glm::dvec3 helper = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(n, helper)), v = glm::cross(n, u);
    for (const glm::dvec2 corner : {glm::dvec2(-4, -4), {4, -4}, {4, 4}, {-4, 4}})
        polygon.push_back(double(offset) * n + corner.x * u + corner.y * v);
    for (int axis = 0; axis < 3; ++axis) {
        polygon = cut(polygon, axis, -1, true);
        polygon = cut(polygon, axis, 1, false);
    }
    Geometry geometry;
    for (const glm::dvec3& p : polygon)
        geometry.vertices.push_back({.position = glm::vec3(p), .normal = normal});
    for (uint32_t i = 2; i < polygon.size(); ++i)
        for (const uint32_t corner : {0u, i - 1, i}) geometry.indices.push_back(corner);
    return geometry;
}

/// Which side of the plane a walk is allowed to see: the voxels whose centres lie in the plane's cube, so that every
/// step between neighbours of two sides crosses the polygon itself.
struct PlaneWalk {
    VoxelMap<bool> blocked;        ///< occupied, or outside of the cube
    VoxelMap<bool> occupied;       ///< in the cube
    std::vector<double> distance;  ///< signed, of voxel centres, by index
    glm::ivec3 start{-1};          ///< the empty voxel farthest on the positive side

    bool leaks() const {
        const VoxelMap<bool> reached = flooded(blocked, start);
        for (size_t i = 0; i < distance.size(); ++i)
            if (reached.values[i] && distance[i] < 0) return true;
        return false;
    }
};

PlaneWalk plane_walk(const VolumeTexels& albedo, const voxels::Grid& grid, glm::vec3 normal, float offset) {
    PlaneWalk walk{.blocked = occupancy_of(albedo), .occupied = occupancy_of(albedo), .distance = {}};
    walk.distance.resize(albedo.texels.size());
    double farthest = 0;
    for (int z = 0; z < albedo.side; ++z)
        for (int y = 0; y < albedo.side; ++y)
            for (int x = 0; x < albedo.side; ++x) {
                const glm::ivec3 v(x, y, z);
                const glm::dvec3 center =
                    glm::dvec3(grid.origin) + (glm::dvec3(v) + 0.5) * double(grid.voxel_size);
                const double d = glm::dot(center, glm::dvec3(normal)) - double(offset);
                walk.distance[walk.blocked.index(v)] = d;
                const bool in_cube = glm::all(glm::lessThan(glm::abs(center), glm::dvec3(1 - 1e-6)));
                if (!in_cube) {
                    walk.blocked.set(v, true);
                    walk.occupied.set(v, false);
                }
                if (!walk.blocked.get(v) && d > farthest) {
                    farthest = d;
                    walk.start = v;
                }
            }
    return walk;
}

TEST_P(VoxelizeTest, PlanesAreWatertight) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> offsets(-0.3f, 0.3f);
    std::vector<glm::vec3> normals{{1, 0, 0},
                                   {0, 1, 0},
                                   {0, 0, 1},
                                   glm::normalize(glm::vec3(1, 1, 0)),
                                   glm::normalize(glm::vec3(1, 1, 1)),
                                   glm::normalize(glm::vec3(1, 0.001f, 0)),
                                   glm::normalize(glm::vec3(0.01f, 1, 0.02f))};
    while (normals.size() < 32) normals.push_back(random_unit(random));
    int removals = 0, leaks_after_removal = 0;
    for (const glm::vec3& normal : normals) {
        const float offset = offsets(random);
        SCOPED_TRACE(fmt::format("normal {} {} {}, offset {}", normal.x, normal.y, normal.z, offset));
        scene::Scene scene;
        add(scene, plane_through_cube(normal, offset), diffuse(glm::vec3(0.5f)));
        const voxels::Grid grid = voxels::fit_grid(scene::world_bounds(scene), 32);
        PlaneWalk walk = plane_walk(albedo_of(scene, 32), grid, normal, offset);
        ASSERT_GE(walk.start.x, 0);
        EXPECT_FALSE(walk.leaks());

        // Without one voxel there is a hole, wherever that voxel alone stood between two empty ones.
        for (int i = 0; i < 5; ++i) {
            size_t removed = random() % walk.occupied.values.size();
            while (!walk.occupied.values[removed]) removed = (removed + 1) % walk.occupied.values.size();
            walk.blocked.values[removed] = false;
            leaks_after_removal += walk.leaks();
            ++removals;
            walk.blocked.values[removed] = true;
        }
    }
    EXPECT_GT(leaks_after_removal, 0.9 * removals);
}

TEST_P(VoxelizeTest, ClosedBodiesAreWatertight) {
    std::mt19937 random(11);
    std::vector<std::pair<std::string, Geometry>> bodies;
    bodies.emplace_back("ball", scene::builtin::faceted_sphere(1, 40, 20));
    bodies.emplace_back("smooth ball", scene::builtin::sphere(1, 24, 12));
    bodies.emplace_back("box", scene::builtin::box(glm::vec3(-1, -0.5f, -0.8f), glm::vec3(1, 0.5f, 0.8f)));
    // Four voxels thin at 32.
    bodies.emplace_back("thin box", scene::builtin::box(glm::vec3(-1, -0.2f, -1), glm::vec3(1, 0.2f, 1)));
    for (const auto& [name, geometry] : bodies) {
        for (int turn = 0; turn < 6; ++turn) {
            SCOPED_TRACE(fmt::format("{}, turn {}", name, turn));
            const float angle = turn == 0 ? 0.0f : float(turn);
            scene::Scene scene;
            add(scene, geometry, diffuse(glm::vec3(0.5f)),
                glm::rotate(glm::mat4(1), angle, turn == 0 ? glm::vec3(0, 1, 0) : random_unit(random)));
            // Something far away on both sides, so that the grid has room around the body.
            for (const glm::vec3 corner : {glm::vec3(-1.6f), glm::vec3(1.6f)})
                add(scene, triangle(corner, corner + glm::vec3(0.01f, 0, 0), corner + glm::vec3(0, 0.01f, 0)),
                    diffuse(glm::vec3(0.5f)));
            VoxelMap<bool> occupied = occupancy_of(albedo_of(scene, 32));
            const glm::ivec3 center(16), outside(0, 16, 31);
            ASSERT_FALSE(occupied.get(center));
            EXPECT_FALSE(flooded(occupied, outside).get(center));
            const VoxelMap<bool> inside = flooded(occupied, center);
            EXPECT_GT(std::count(inside.values.begin(), inside.values.end(), true), 20);

            // A hole of one voxel is found: the first on the way from the middle along y.
            glm::ivec3 wall = center;
            while (!occupied.get(wall)) ++wall.y;
            int thickness = 0;
            while (occupied.get(wall + glm::ivec3(0, thickness, 0))) {
                occupied.set(wall + glm::ivec3(0, thickness, 0), false);
                ++thickness;
            }
            EXPECT_LE(thickness, 3);
            EXPECT_TRUE(flooded(occupied, outside).get(center));
        }
    }
}

TEST_P(VoxelizeTest, FragmentsAreCounted) {
    const scene::Scene scene = ball_scene();
    const scene::GpuScene gpu = value_of(scene::GpuScene::create(device(), scene, true));
    const voxels::OctreeStatistics statistics =
        value_of(voxels::octree_statistics(device(), gpu.view(), side, std::get<1>(GetParam())));
    const VoxelMap<VoxelSums> expected =
        voxelized_on_cpu(grid_triangles(scene, voxels::fit_grid(scene::world_bounds(scene), side)), side);
    uint64_t least = 0, greatest = 0;
    for (const VoxelSums& sums : expected.values) {
        least += sums.least_hits;
        greatest += sums.greatest_hits;
    }
    EXPECT_GE(statistics.fragments, least);
    EXPECT_LE(statistics.fragments, greatest);
    EXPECT_GT(double(least), 0.9 * double(greatest));
}

}  // namespace
}  // namespace lumo
