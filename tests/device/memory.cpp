// Memory of resources: never shared by two that live, given back by those that died, refused beyond what there is.
#include <algorithm>
#include <numeric>
#include <random>

#include "tests/support/device_test.hpp"

namespace lumo::testing_support {
namespace {

using namespace rhi;

/// The same numbers on every machine, each below `limit`.
class Random {
  public:
    uint32_t below(uint32_t limit) { return uint32_t(engine_() % limit); }

  private:
    std::mt19937 engine_;
};

class DeviceMemory : public DeviceTest {
  protected:
    uint64_t live_bytes() {
        auto entries = device().memory();
        return std::accumulate(entries.begin(), entries.end(), uint64_t(0),
                               [](uint64_t sum, const MemoryEntry& entry) { return sum + entry.bytes; });
    }
    /// Lets the device forget what was destroyed.
    void idle() {
        for (int i = 0; i < 3; ++i) must(device().wait(device().submit(device().begin())));
    }
};

TEST_P(DeviceMemory, LiveBuffersNeverOverlap) {
    Random random;
    struct Tagged {
        Buffer buffer;
        std::byte tag;
    };
    std::vector<Tagged> live(200);
    for (int round = 0; round < 8; ++round) {
        for (auto& [buffer, tag] : live) {
            if (buffer && random.below(2)) continue;
            uint32_t size = 1 + (random.below(8) ? random.below(5000) : random.below(2'000'000));
            buffer =
                must(device().create_buffer({.name = "tagged",
                                             .size = size,
                                             .memory = random.below(2) ? Memory::upload : Memory::readback}));
            tag = std::byte(random.below(256));
            std::fill_n(buffer.mapped(), size, tag);
        }
        idle();
        for (const auto& [buffer, tag] : live) {
            const std::span<const std::byte> held(buffer.mapped(), buffer.size());
            ASSERT_EQ(std::count(held.begin(), held.end(), tag), std::ptrdiff_t(held.size()))
                << "round " << round;
        }
    }
}

TEST_P(DeviceMemory, LiveTexturesNeverOverlap) {
    Random random;
    struct Tagged {
        Texture texture;
        uint32_t tag = 0;
    };
    std::vector<Tagged> live(24);
    for (int round = 0; round < 4; ++round) {
        for (auto& [texture, tag] : live) {
            if (texture && random.below(2)) continue;
            tag = random.below(UINT32_MAX);
            texture =
                must(device().create_texture({.name = "tagged",
                                              .format = Format::r32_uint,
                                              .extent = {1 + random.below(200), 1 + random.below(200)}}));
            Commands commands = device().begin();
            commands.pass("tag").clear(texture.view(), std::array{tag, 0u, 0u, 0u});
        }
        for (const auto& [texture, tag] : live) {
            auto held = texels<uint32_t>(texture);
            ASSERT_EQ(std::count(held.begin(), held.end(), tag), std::ptrdiff_t(held.size()))
                << "round " << round;
        }
    }
}

TEST_P(DeviceMemory, WhatDiedIsNoLongerCounted) {
    idle();
    const uint64_t before = live_bytes();
    {
        Texture texture = this->texture({.name = "large", .extent = {512, 512}});
        Buffer buffer = this->buffer(100'000);
        EXPECT_GE(live_bytes(), before + 512 * 512 * 4 + 100'000);
    }
    idle();
    EXPECT_EQ(live_bytes(), before);
}

TEST_P(DeviceMemory, TooMuchIsAnErrorAndHarmsNothing) {
    auto buffer = device().create_buffer({.name = "huge buffer", .size = uint64_t(1) << 50});
    ASSERT_FALSE(buffer);
    EXPECT_TRUE(buffer.error().kind == ErrorKind::out_of_memory ||
                buffer.error().kind == ErrorKind::unsupported)
        << to_string(buffer.error());
    EXPECT_EQ(buffer.error().subject, "huge buffer");
    const uint32_t side = device().info().limits.max_texture_side_2d;
    auto texture = device().create_texture({.name = "wide texture", .extent = {side + 1, 1}});
    ASSERT_FALSE(texture);
    EXPECT_EQ(texture.error().kind, ErrorKind::unsupported) << to_string(texture.error());

    std::vector<uint32_t> values{1, 2, 3};
    EXPECT_EQ(contents<uint32_t>(buffer_with(values)), values);
    take_failures();
}

INSTANTIATE_TEST_SUITE_P(Apis, DeviceMemory, both_apis, api_name);

}  // namespace
}  // namespace lumo::testing_support
