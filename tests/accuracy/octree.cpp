// An octree holds what a dense volume holds: over marks of any shape it has the nodes that it must have and no other,
// and the same values at every level, to the bit.
#include "techniques/voxels/octree.hpp"

#include <bit>
#include <fmt/format.h>
#include <functional>
#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "shaders/test_accuracy/sample_voxels.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/octree.hpp"
#include "tests/support/voxelizer.hpp"

namespace lumo {
namespace {

using namespace testing_support;

using Shape = std::function<bool(glm::ivec3)>;

struct OctreeTest : DeviceTest {
    /// Marks the voxels of a shape and makes an octree over them.
    voxels::Octree octree_of(const VoxelMap<bool>& shape, const voxels::OctreeSettings& settings) {
        voxels::Occupancy counting = must(voxels::Occupancy::create(device(), settings.resolution));
        mark(shape, counting);
        size_ = must(counting.size(device()));
        voxels::Octree octree = must(voxels::Octree::create(device(), settings, size_));
        mark(shape, octree.occupancy());
        rhi::Commands commands = device().begin();
        octree.index(commands);
        must(device().wait(device().submit(std::move(commands))));
        return octree;
    }

    void mark(const VoxelMap<bool>& shape, voxels::Occupancy& occupancy) {
        const int side = shape.side;
        const glm::ivec3 extent(side / 4, side / 4, side / 2);
        std::vector<uint32_t> words(size_t(extent.x) * size_t(extent.y) * size_t(extent.z));
        for (int z = 0; z < side; ++z)
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) {
                    const BitPlace place = bit_place({x, y, z}, extent);
                    if (shape.get({x, y, z})) words[place.word] |= 1u << place.bit;
                }
        rhi::Commands commands = device().begin();
        occupancy.clear(commands);
        commands.pass("mark").upload(occupancy.bits(), rhi::whole_mip(occupancy.bits().desc()),
                                     bytes_of(words));
        occupancy.record(commands);
        must(device().wait(device().submit(std::move(commands))));
    }

    /// Texels of a whole grid, `stride` bytes each, into the octree's list.
    void upload_cells(const voxels::Octree& octree, const std::vector<std::byte>& texels, size_t stride) {
        const rhi::Extent cells = octree.cell_extent();
        const int side = 1 << octree.levels();
        std::vector<std::byte> listed(stride * cells.width * cells.height * cells.depth);
        const auto list = values_of<uint32_t>(must(device().download(octree.voxels())));
        for (size_t place = 0; place < size_.voxels; ++place) {
            const glm::ivec3 v(list[place] & 1023, list[place] >> 10 & 1023, list[place] >> 20);
            const size_t voxel = (size_t(v.z) * size_t(side) + size_t(v.y)) * size_t(side) + size_t(v.x);
            std::memcpy(listed.data() + place * stride, texels.data() + voxel * stride, stride);
        }
        must(device().upload(octree.cells(), rhi::whole_mip(octree.cells().desc()), listed));
    }

    voxels::OctreeSize size_;
};
INSTANTIATE_TEST_SUITE_P(Accuracy, OctreeTest, both_apis, api_name);

VoxelMap<bool> make_shape(uint32_t side, const Shape& occupied) {
    VoxelMap<bool> shape(side, false);
    for (int z = 0; z < int(side); ++z)
        for (int y = 0; y < int(side); ++y)
            for (int x = 0; x < int(side); ++x) shape.set({x, y, z}, occupied({x, y, z}));
    return shape;
}

struct NamedShape {
    std::string name;
    VoxelMap<bool> shape;
};
std::vector<NamedShape> shapes() {
    std::mt19937 random(3);
    const auto one = [](uint32_t side, glm::ivec3 where) {
        return make_shape(side, [=](glm::ivec3 v) { return v == where; });
    };
    std::vector<NamedShape> all;
    all.push_back({"empty", make_shape(32, [](glm::ivec3) { return false; })});
    all.push_back({"first voxel", one(32, glm::ivec3(0))});
    all.push_back({"last voxel", one(32, glm::ivec3(31))});
    all.push_back({"low corner of a node", one(64, {32, 16, 48})});
    all.push_back({"inside a node", one(64, {33, 18, 47})});
    all.push_back({"full", make_shape(16, [](glm::ivec3) { return true; })});
    all.push_back(
        {"full, with more bricks than a square holds", make_shape(32, [](glm::ivec3) { return true; })});
    all.push_back({"sphere", make_shape(64, [](glm::ivec3 v) {
                       const float r = glm::length(glm::vec3(v) - 30.2f);
                       return r > 20 && r < 21.5f;
                   })});
    all.push_back({"scattered", make_shape(64, [&](glm::ivec3) { return random() % 500 == 0; })});
    all.push_back({"crowded", make_shape(32, [&](glm::ivec3) { return random() % 3 == 0; })});
    all.push_back({"wall on a node's face", make_shape(32, [](glm::ivec3 v) { return v.y == 16; })});
    return all;
}

/// Values of which none is black where a voxel is occupied.
std::vector<uint8_t> random_values(const VoxelMap<bool>& shape, std::mt19937& random) {
    std::vector<uint8_t> values(shape.values.size() * 4);
    for (size_t i = 0; i < values.size(); ++i)
        if (shape.values[i / 4]) values[i] = uint8_t(1 + random() % 255);
    return values;
}

TEST_P(OctreeTest, HoldsWhatTheVolumeHolds) {
    std::mt19937 random(7);
    for (const auto& [name, shape] : shapes()) {
        for (const voxels::MipKind mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic}) {
            for (const bool wide : {false, true}) {
                if (wide && name != "crowded" && name != "sphere") continue;
                SCOPED_TRACE(fmt::format("{}, {} voxels a side, {}, {}", name, shape.side,
                                         mips == voxels::MipKind::isotropic ? "isotropic" : "anisotropic",
                                         wide ? "half floats" : "8 bits"));
                const voxels::OctreeSettings settings{.resolution = uint32_t(shape.side),
                                                      .mips = mips,
                                                      .wide_range = wide,
                                                      .list_voxels = true};
                voxels::Octree octree = octree_of(shape, settings);
                const auto occupied = size_t(std::count(shape.values.begin(), shape.values.end(), true));
                ASSERT_EQ(size_.voxels, occupied);

                // The list has each occupied voxel once.
                const std::vector<uint8_t> values = random_values(shape, random);
                const size_t stride = wide ? 8 : 4;
                std::vector<std::byte> texels(stride * shape.values.size());
                for (size_t i = 0; i < values.size(); ++i) {
                    const uint16_t half = glm::packHalf1x16(float(values[i]) / 255);
                    std::memcpy(texels.data() + i * stride / 4,
                                wide ? static_cast<const void*>(&half) : &values[i], stride / 4);
                }
                const auto list = values_of<uint32_t>(must(device().download(octree.voxels())));
                std::set<size_t> seen;
                for (size_t place = 0; place < occupied; ++place) {
                    const glm::ivec3 v(list[place] & 1023, list[place] >> 10 & 1023, list[place] >> 20);
                    ASSERT_TRUE(shape.contains(v) && shape.get(v));
                    ASSERT_TRUE(seen.insert(shape.index(v)).second);
                }
                upload_cells(octree, texels, stride);

                auto dense =
                    must(voxels::LightVolume::create(device(), "dense", uint32_t(shape.side), mips, wide));
                must(device().upload(dense.base, rhi::whole_mip(dense.base.desc()), texels));

                const auto light = must(octree.create_light(device(), "sparse"));
                const auto dense_mips = must(voxels::Mips::create(device(), mips));
                rhi::Commands commands = device().begin();
                {
                    rhi::Pass pass = commands.pass("fill");
                    octree.fill(pass, light);
                    dense_mips.record(pass, dense);
                }
                must(device().wait(device().submit(std::move(commands))));

                const OctreeTexels read(device(), octree, light, mips == voxels::MipKind::isotropic ? 1 : 6);
                const OctreeDifference difference = compare_octree(device(), read, dense);
                EXPECT_EQ(difference.unequal, 0u) << "of " << difference.compared;
                EXPECT_EQ(difference.missing, 0u);
                EXPECT_EQ(difference.nodes, size_.fine_nodes() + size_.coarse_nodes());
            }
        }
    }
}

/// As shaders/test_accuracy/sample_voxels.comp has it.
struct Place {
    glm::vec3 uvw;
    float lod;
    glm::vec3 direction;
    float opacity;
    glm::vec4 value;
};

std::vector<Place> random_places(int side, size_t count, std::mt19937& random) {
    std::uniform_real_distribution<float> unit(0, 1);
    std::normal_distribution<float> normal;
    std::vector<Place> places(count);
    for (Place& place : places) {
        place.lod = unit(random) * (std::log2(float(side)) + 1);
        if (random() % 2) place.lod = std::floor(place.lod);
        place.uvw = {unit(random), unit(random), unit(random)};
        // A volume's directions lie side by side: nearer to their ends than half a texel it repeats the last one.
        const float margin =
            std::min(std::exp2(std::ceil(std::max(place.lod - 1, 0.0f))) / float(side), 0.5f);
        place.uvw.x = std::clamp(place.uvw.x, margin, 1 - margin);
        place.direction = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    }
    return places;
}

/// Light of random opacity, and of a radiance from 0 to 1.
std::vector<std::byte> random_light(const VoxelMap<bool>& shape, std::mt19937& random) {
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<uint64_t> texels(shape.values.size());
    for (size_t i = 0; i < texels.size(); ++i) {
        const float opacity = unit(random);
        if (shape.values[i])
            texels[i] = glm::packHalf4x16(
                glm::vec4(unit(random) * opacity, unit(random) * opacity, unit(random) * opacity, opacity));
    }
    const auto bytes = bytes_of(texels);
    return {bytes.begin(), bytes.end()};
}

TEST_P(OctreeTest, SamplesAreTheVolumes) {
    std::mt19937 random(11);
    for (const auto& [name, shape] : shapes()) {
        for (const voxels::MipKind mips : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic}) {
            const bool anisotropic = mips == voxels::MipKind::anisotropic;
            SCOPED_TRACE(name + (anisotropic ? ", anisotropic" : ", isotropic"));
            const auto side = uint32_t(shape.side);
            const int32_t levels = std::countr_zero(side);
            voxels::Octree octree =
                octree_of(shape, {.resolution = side, .mips = mips, .wide_range = true, .list_voxels = true});
            const auto light = must(octree.create_light(device(), "sparse"));
            auto dense = must(voxels::LightVolume::create(device(), "dense", side, mips, true));
            const std::vector<std::byte> texels = random_light(shape, random);
            must(device().upload(dense.base, rhi::whole_mip(dense.base.desc()), texels));
            upload_cells(octree, texels, 8);
            const auto dense_mips = must(voxels::Mips::create(device(), mips));

            const std::vector<Place> places = random_places(shape.side, 4096, random);
            std::vector<Place> whole_places = places;
            for (Place& place : whole_places) place.lod = std::floor(place.lod);
            // Of any level, and by the ways that whole ones are read, the volume's beside the octree's.
            const rhi::Buffer from_octree = buffer_with(places), from_volume = buffer_with(places);
            const rhi::Buffer whole_octree = buffer_with(whole_places),
                              whole_volume = buffer_with(whole_places),
                              whole_expected = buffer_with(whole_places);
            using Program = shaders::test_accuracy::sample_voxels;
            const auto sparse_pipeline =
                compute<Program>({.anisotropic = anisotropic, .octree_levels = levels});
            const auto sparse_whole_pipeline =
                compute<Program>({.anisotropic = anisotropic, .octree_levels = levels, .whole_levels = true});
            const auto dense_pipeline = compute<Program>({.anisotropic = anisotropic});
            const auto dense_whole_pipeline =
                compute<Program>({.anisotropic = anisotropic, .whole_levels = true});
            const rhi::Sampler linear = sampler({.mip = rhi::FilterMode::linear});
            rhi::Commands commands = device().begin();
            {
                rhi::Pass pass = commands.pass("sample");
                octree.fill(pass, light);
                dense_mips.record(pass, dense);
                const auto dispatch = [&](const auto& pipeline, const voxels::LightVolume& volume,
                                          const rhi::Buffer& target) {
                    const voxels::LightVolumeView view = voxels::view_of(volume);
                    pass.dispatch(pipeline,
                                  {.base = {view.base, linear},
                                   .directions = {view.directions, linear},
                                   .places = target.slice(),
                                   .voxel_nodes = octree.nodes()},
                                  {.count = uint32_t(places.size()), .resolution = float(side)},
                                  {rhi::groups_for(uint32_t(places.size()), 64)});
                };
                dispatch(sparse_pipeline, light, from_octree);
                dispatch(dense_pipeline, dense, from_volume);
                dispatch(sparse_whole_pipeline, light, whole_octree);
                dispatch(dense_whole_pipeline, dense, whole_volume);
                dispatch(dense_pipeline, dense, whole_expected);
            }
            must(device().wait(device().submit(std::move(commands))));

            const auto compare = [&](const rhi::Buffer& buffer, const rhi::Buffer& expected_buffer) {
                const auto sampled = contents<Place>(buffer), expected = contents<Place>(expected_buffer);
                size_t lit = 0, unseen = 0;
                float worst = 0;
                for (size_t i = 0; i < sampled.size(); ++i) {
                    const glm::vec4 difference = glm::abs(sampled[i].value - expected[i].value);
                    worst = std::max({worst, difference.r, difference.g, difference.b, difference.a});
                    lit += expected[i].value.a > 0;
                    // What a level says to be empty is empty for every direction there.
                    unseen += sampled[i].opacity == 0 && sampled[i].lod == std::floor(sampled[i].lod) &&
                              expected[i].value.a > 1e-5f;
                }
                EXPECT_LT(worst, 2e-3f);
                EXPECT_EQ(unseen, 0u);
                if (name != "empty") {
                    EXPECT_GT(lit, 100u);
                }
            };
            compare(from_octree, from_volume);
            compare(whole_octree, whole_expected);
            compare(whole_volume, whole_expected);
        }
    }
}

/// Whether a node's voxels, or the next ones on its far sides, hold anything.
bool must_exist(const VoxelMap<bool>& shape, glm::ivec3 node) {
    for (int i = 0; i < 125; ++i) {
        const glm::ivec3 v = node * 4 + glm::ivec3(i % 5, i / 5 % 5, i / 25);
        if (shape.contains(v) && shape.get(v)) return true;
    }
    return false;
}

VoxelMap<bool> coarser(const VoxelMap<bool>& shape) {
    return make_shape(uint32_t(shape.side / 2), [&](glm::ivec3 v) {
        for (int child = 0; child < 8; ++child)
            if (shape.get(v * 2 + (glm::ivec3(child) >> glm::ivec3(0, 1, 2) & 1))) return true;
        return false;
    });
}

TEST_P(OctreeTest, HasTheNodesThatItNeedsAndNoOthersEachInASlotOfItsOwn) {
    for (const auto& [name, shape] : shapes()) {
        SCOPED_TRACE(name);
        const voxels::Octree octree =
            octree_of(shape, {.resolution = uint32_t(shape.side), .mips = voxels::MipKind::isotropic});
        const auto light = must(octree.create_light(device(), "light"));
        const OctreeTexels read(device(), octree, light, 1);
        std::set<int> fine, coarse;
        VoxelMap<bool> occupied = shape;
        size_t wrong = 0;
        for (int level = 0; level <= read.levels(); ++level) {
            const int nodes = std::max(read.side(level) / 4, 1);
            for (int i = 0; i < nodes * nodes * nodes; ++i) {
                const glm::ivec3 node(i % nodes, i / nodes % nodes, i / nodes / nodes);
                const auto slot = read.slot(node, level);
                if (slot) {
                    EXPECT_TRUE((level == 0 ? fine : coarse).insert(*slot).second);
                }
                // The single nodes at the top are always there.
                if (nodes > 1) wrong += slot.has_value() != must_exist(occupied, node);
            }
            if (occupied.side > 1) occupied = coarser(occupied);
        }
        EXPECT_EQ(wrong, 0u);
        const auto is_row = [](const std::set<int>& slots, uint32_t count) {
            return slots.size() == count && (slots.empty() || *slots.rbegin() == int(count) - 1);
        };
        EXPECT_TRUE(is_row(fine, size_.fine_nodes()));
        EXPECT_TRUE(is_row(coarse, size_.coarse_nodes()));
    }
}

/// More than there was room for: the first nodes are there, nothing is written elsewhere.
TEST_P(OctreeTest, WhatExceedsTheRoomIsLeftOut) {
    const VoxelMap<bool> few = make_shape(32, [](glm::ivec3 v) { return v.y == 3 && v.x < 8; });
    const VoxelMap<bool> many = make_shape(32, [](glm::ivec3 v) { return v.y % 8 == 3; });
    voxels::Octree octree =
        octree_of(few, {.resolution = 32, .mips = voxels::MipKind::isotropic, .list_voxels = true});
    mark(many, octree.occupancy());
    rhi::Commands commands = device().begin();
    octree.index(commands);
    must(device().wait(device().submit(std::move(commands))));
    const auto light = must(octree.create_light(device(), "light"));
    const OctreeTexels read(device(), octree, light, 1);
    uint32_t fine = 0;
    for (int i = 0; i < 8 * 8 * 8; ++i) {
        const auto slot = read.slot({i % 8, i / 8 % 8, i / 64}, 0);
        fine += slot.has_value();
        if (slot) {
            EXPECT_LT(*slot, int(size_.fine_nodes()));
        }
    }
    EXPECT_GT(fine, 0u);
    EXPECT_LE(fine, size_.fine_nodes());
}

}  // namespace
}  // namespace lumo
