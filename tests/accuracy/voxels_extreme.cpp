// Shapes and scales at which a voxelizer may slip.
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "tests/support/voxelize_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct ExtremeVoxelsTest : VoxelizerTest {
    VoxelMap<bool> occupied(const scene::Scene& scene, VoxelOptions options = {}) {
        const Voxelized made = voxelized(scene, options);
        return occupancy_of(read_volume(device(), made.volume.albedo()));
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, ExtremeVoxelsTest, each_voxelizer, voxelizer_name);

constexpr int side = 32;
constexpr float voxel = 2.0f / float(side - 1);  // of a grid around [-1, 1]³
const scene::Bounds unit_bounds{.min = glm::vec3(-1), .max = glm::vec3(1)};

glm::dvec3 in_grid(glm::vec3 world) { return glm::dvec3(world) / double(voxel) + 0.5 * side; }

template <class Visit>
void for_each_voxel(const VoxelMap<bool>& map, const Visit& visit) {
    for (int z = 0; z < map.side; ++z)
        for (int y = 0; y < map.side; ++y)
            for (int x = 0; x < map.side; ++x) visit(glm::ivec3(x, y, z));
}

size_t count(const VoxelMap<bool>& map) {
    return size_t(std::count(map.values.begin(), map.values.end(), true));
}

size_t different(const VoxelMap<bool>& a, const VoxelMap<bool>& b) {
    size_t sum = 0;
    for (size_t i = 0; i < a.values.size(); ++i) sum += a.values[i] != b.values[i];
    return sum;
}

/// Nothing lies along the grid, and corners are exact in few bits, so that moving and scaling rounds nothing.
scene::Scene turned_box() {
    scene::Scene scene;
    scene::builtin::Geometry geometry = scene::builtin::box({-0.7f, -0.3f, -0.5f}, {0.7f, 0.3f, 0.5f});
    const glm::mat4 turn = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 3)));
    for (auto& vertex : geometry.vertices)
        vertex.position = glm::round(glm::vec3(turn * glm::vec4(vertex.position, 1)) * 1024.0f) / 1024.0f;
    add(scene, geometry, diffuse(glm::vec3(0.5f)));
    return scene;
}

TEST_P(ExtremeVoxelsTest, NoTrianglesAndNoAreaMarkNothing) {
    scene::Scene degenerate;
    const glm::vec3 p(0.3f, -0.2f, 0.1f), q(-0.6f, 0.5f, 0.4f);
    add(degenerate, triangle(p, p, p), diffuse(glm::vec3(1)));
    add(degenerate, triangle(p, q, q), diffuse(glm::vec3(1)));
    add(degenerate, triangle(p, q, p), diffuse(glm::vec3(1)));
    add(degenerate, triangle({-1, 0, 0}, {0, 0, 0}, {1, 0, 0}), diffuse(glm::vec3(1)));
    for (const scene::Scene& scene : {scene::Scene{}, degenerate})
        EXPECT_EQ(count(occupied(scene, {.bounds = unit_bounds})), 0u);
}

TEST_P(ExtremeVoxelsTest, NeedlesMarkOnlyWhatTheyTouch) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const auto point = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
    scene::Scene scene;
    std::vector<std::pair<glm::dvec3, glm::dvec3>> needles;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 a = point(), b = point(), off = 0.05f * voxel * point();
        needles.emplace_back(in_grid(a), in_grid(b));
        add(scene, triangle(a, b, a + off), diffuse(glm::vec3(1)));
    }
    const VoxelMap<bool> map = occupied(scene, {.bounds = unit_bounds});
    EXPECT_GT(count(map), 50u);
    size_t far_off = 0;
    for_each_voxel(map, [&](glm::ivec3 v) {
        if (!map.get(v)) return;
        const glm::dvec3 center = glm::dvec3(v) + 0.5;
        double nearest = 1e9;
        for (const auto& [a, b] : needles) {
            const double t = std::clamp(glm::dot(center - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
            nearest = std::min(nearest, glm::distance(center, a + t * (b - a)));
        }
        far_off += nearest > std::sqrt(0.75) + 0.1;
    });
    EXPECT_EQ(far_off, 0u);
}

TEST_P(ExtremeVoxelsTest, TrianglesLargerThanTheGridFillTheirPlane) {
    for (const float size : {3.0f, 100.0f, 3000.0f}) {
        SCOPED_TRACE(fmt::format("{} m", size));
        // z = 0.2 x + 0.1 y + 0.05, around the whole grid: each column along z has one voxel at least.
        const auto at = [](float x, float y) { return glm::vec3(x, y, 0.2f * x + 0.1f * y + 0.05f); };
        scene::Scene scene;
        add(scene, triangle(at(-2 * size, -size), at(2 * size, -size), at(0, 2 * size)),
            diffuse(glm::vec3(1)));
        const VoxelMap<bool> map = occupied(scene, {.bounds = unit_bounds});
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                bool found = false;
                for (int z = 0; z < side; ++z) {
                    if (!map.get({x, y, z})) continue;
                    found = true;
                    // The plane's height where it leaves the voxel farthest, which is 0.15 off its centre.
                    const double world_x = (x + 0.5 - 0.5 * side) * double(voxel),
                                 world_y = (y + 0.5 - 0.5 * side) * double(voxel);
                    const double height = (0.2 * world_x + 0.1 * world_y + 0.05) / double(voxel) + 0.5 * side;
                    EXPECT_NEAR(z + 0.5, height, 0.5 + 0.15 + 0.01 * double(size) / 1000);
                }
                EXPECT_TRUE(found) << x << ' ' << y;
            }
    }
}

TEST_P(ExtremeVoxelsTest, SurfacesOnVoxelFacesAreOneVoxelThick) {
    for (int axis = 0; axis < 3; ++axis)
        for (const int face : {1, 7, 16, 31}) {
            SCOPED_TRACE(fmt::format("axis {}, face {}", axis, face));
            glm::vec3 corner(-2), right(0), up(0);
            corner[axis] = (float(face) - 0.5f * float(side)) * voxel;
            right[(axis + 1) % 3] = 4;
            up[(axis + 2) % 3] = 4;
            scene::Scene scene;
            add(scene, scene::builtin::parallelogram(corner, right, up), diffuse(glm::vec3(1)));
            const VoxelMap<bool> map = occupied(scene, {.bounds = unit_bounds});
            EXPECT_EQ(count(map), size_t(side) * side);
            for_each_voxel(map, [&](glm::ivec3 v) {
                if (map.get(v)) {
                    EXPECT_TRUE(v[axis] == face || v[axis] == face - 1);
                }
            });
        }
}

TEST_P(ExtremeVoxelsTest, TenThousandTrianglesInOneVoxelStayInIt) {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> uniform(0.02f, 0.98f);
    const auto point = [&] { return voxel * glm::vec3(uniform(random), uniform(random), uniform(random)); };
    scene::Scene scene;
    scene::builtin::Geometry geometry;
    for (uint32_t i = 0; i < 10'000; ++i)
        for (uint32_t c = 0; c < 3; ++c) {
            geometry.vertices.push_back({.position = point(), .normal = {0, 1, 0}});
            geometry.indices.push_back(3 * i + c);
        }
    add(scene, geometry, diffuse({0.8f, 0.4f, 0.2f}));
    const Voxelized made = voxelized(scene, {.bounds = unit_bounds, .normals = true});
    const VolumeTexels albedo = read_volume(device(), made.volume.albedo());
    const VoxelMap<bool> map = occupancy_of(albedo);
    EXPECT_EQ(count(map), 1u);
    ASSERT_TRUE(map.get(glm::ivec3(side / 2)));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(albedo.at(glm::ivec3(side / 2))[c], (glm::vec3{0.8f, 0.4f, 0.2f})[c], 1.01f / 255);
}

TEST_P(ExtremeVoxelsTest, AMillimetreAndAHundredKilometresAreAMetre) {
    const VoxelMap<bool> metre = occupied(turned_box());
    EXPECT_GT(count(metre), 500u);
    for (const int exponent : {-10, 17}) {
        SCOPED_TRACE(fmt::format("2^{} m", exponent));
        scene::Scene scene = turned_box();
        for (auto& vertex : scene.vertices) vertex.position *= std::exp2(float(exponent));
        EXPECT_EQ(different(occupied(scene), metre), 0u);
    }
}

TEST_P(ExtremeVoxelsTest, AQuarterTurnTurnsTheVoxels) {
    const VoxelMap<bool> still = occupied(turned_box(), {.bounds = unit_bounds});
    scene::Scene scene = turned_box();
    for (auto& vertex : scene.vertices)
        vertex.position = {vertex.position.z, vertex.position.y, -vertex.position.x};
    const VoxelMap<bool> turned = occupied(scene, {.bounds = unit_bounds});
    VoxelMap<bool> expected(side, false);
    for_each_voxel(still, [&](glm::ivec3 v) { expected.set({v.z, v.y, side - 1 - v.x}, still.get(v)); });
    // A centre line on an edge, to the 256th of a voxel, may fall to the other side.
    EXPECT_LE(different(turned, expected), count(still) / 200);
}

TEST_P(ExtremeVoxelsTest, AGridMovedByWholeVoxelsHasTheSameVoxels) {
    const VoxelMap<bool> still = occupied(turned_box(), {.bounds = unit_bounds});
    const glm::ivec3 shift(3, -2, 1);
    const glm::vec3 offset = voxel * glm::vec3(shift);
    const VoxelMap<bool> moved =
        occupied(turned_box(),
                 {.bounds = scene::Bounds{.min = unit_bounds.min + offset, .max = unit_bounds.max + offset}});
    size_t wrong = 0;
    for_each_voxel(moved, [&](glm::ivec3 v) {
        if (still.contains(v + shift)) wrong += moved.get(v) != still.get(v + shift);
    });
    EXPECT_LE(wrong, count(still) / 200);
    EXPECT_GT(count(moved), 500u);
}

/// A grid that follows a camera: what two places of it share has the same voxels.
TEST_P(ExtremeVoxelsTest, AGridAroundACameraKeepsWhatStandsStill) {
    const scene::Scene scene = turned_box();
    const glm::vec3 eye(0.31f, -0.17f, 0.05f);
    const voxels::Grid grid = voxels::grid_around(eye, 1.9f, side);
    EXPECT_NEAR(grid.voxel_size * side, 1.9f, 1.9f / 512);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(grid.origin[c] + 0.5f * side * grid.voxel_size, eye[c], 4.01f * grid.voxel_size);
    const VoxelMap<bool> still = occupied(scene, {.grid = grid});
    EXPECT_GT(count(still), 300u);
    for (const glm::vec3 way : {glm::vec3(3, 0, 0), glm::vec3(3, -11, 5), glm::vec3(-9, 3, 14)}) {
        const voxels::Grid there = voxels::grid_around(eye + way * grid.voxel_size, 1.9f, side);
        const glm::vec3 moved = (there.origin - grid.origin) / grid.voxel_size;
        const glm::ivec3 shift(glm::round(moved));
        EXPECT_EQ(glm::vec3(shift), moved);
        EXPECT_EQ(shift % 8, glm::ivec3(0));
        const VoxelMap<bool> seen = occupied(scene, {.grid = there});
        size_t wrong = 0, shared = 0;
        for_each_voxel(seen, [&](glm::ivec3 v) {
            if (!still.contains(v + shift)) return;
            shared += seen.get(v);
            wrong += seen.get(v) != still.get(v + shift);
        });
        EXPECT_GT(shared, 100u);
        EXPECT_LE(wrong, shared / 200);
    }
}

/// A grid that moves on, from frame to frame in one volume, leaves nothing behind.
TEST_P(ExtremeVoxelsTest, AGridThatMovesIsAsOneThatWasThere) {
    const scene::Scene scene = turned_box();
    const scene::GpuScene gpu = value_of(scene::GpuScene::create(device(), scene, true));
    const scene::GeometryView geometry = gpu.view();
    const auto at = [](float x) { return voxels::grid_around({x, 0.1f, 0}, 1.5f, side); };
    Voxelized fresh = voxelized(scene, {.grid = at(0.4f)});
    voxels::Volume volume = value_of(voxels::Volume::create(
        device(), {.resolution = side, .voxelizer = std::get<1>(GetParam())},
        {.triangles = voxels::count_triangles(geometry), .draws = uint32_t(geometry.draws.size())}));
    for (const float x : {-0.6f, 0.0f, 0.4f}) {
        rhi::Commands commands = device().begin();
        volume.voxelize(commands, geometry, 0, at(x));
        volume.inject(commands, nullptr);
        value_of(device().wait(device().submit(std::move(commands))));
    }
    const auto expect_equal = [&](const rhi::Texture& a, const rhi::Texture& b) {
        for (uint32_t mip = 0; mip < a.desc().mips; ++mip)
            EXPECT_EQ(read_volume(device(), a, mip).bytes, read_volume(device(), b, mip).bytes)
                << a.desc().name << " mip " << mip;
    };
    expect_equal(volume.albedo(), fresh.volume.albedo());
    expect_equal(volume.area(), fresh.volume.area());
    expect_equal(volume.radiance().base, fresh.volume.radiance().base);
    expect_equal(volume.radiance().directions, fresh.volume.radiance().directions);
}

}  // namespace
}  // namespace lumo
