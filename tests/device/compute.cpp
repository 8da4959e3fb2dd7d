// Buffers, copies, dispatches, atomics and indirect work.
#include <numeric>

#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/arguments.hpp"
#include "shaders/test_rhi/count.hpp"
#include "shaders/test_rhi/scale.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using shaders::test_rhi::advance;
using shaders::test_rhi::arguments;
using shaders::test_rhi::count;
using shaders::test_rhi::scale;
using testing::Each;
using testing::ElementsAre;

struct ComputeTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Device, ComputeTest, both_apis, api_name);

std::vector<int32_t> ramp(size_t size, int32_t first = 0) {
    std::vector<int32_t> values(size);
    std::iota(values.begin(), values.end(), first);
    return values;
}

TEST_P(ComputeTest, BuffersKeepWhatIsUploaded) {
    for (size_t size : {1, 3, 4, 255, 65537}) {
        Buffer mine = buffer(size);
        std::vector<std::byte> bytes(size);
        for (size_t i = 0; i < size; ++i) bytes[i] = std::byte(i * 31 + 5);
        must(device().upload(mine.slice(), bytes));
        EXPECT_EQ(must(device().download(mine.slice())), bytes) << size;
    }
}

TEST_P(ComputeTest, PartsOfBuffersAreCopiedAndFilled) {
    Buffer source = buffer_with(ramp(256));
    Buffer target = buffer(1024);
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("copies");
        pass.fill(target.slice(), 0xffffffff);
        pass.copy(source.slice(40, 80), target.slice(400, 80));
        pass.copy(target.slice(400, 40), target.slice(800, 40));
        pass.fill(target.slice(404, 8), 7);
        const std::vector<int32_t> one{-5};
        pass.upload(target.slice(1020, 4), bytes_of(one));
    }
    device().submit(std::move(commands));
    std::vector<int32_t> expected(256, -1);
    for (int i = 0; i < 20; ++i) expected[100 + i] = 10 + i;
    for (int i = 0; i < 10; ++i) expected[200 + i] = 10 + i;
    expected[101] = expected[102] = 7;
    expected[255] = -5;
    EXPECT_EQ(contents<int32_t>(target), expected);
}

TEST_P(ComputeTest, HostVisibleBuffersAreMapped) {
    Buffer upload = must(device().create_buffer({.name = "up", .size = 256, .memory = Memory::upload}));
    Buffer download = must(device().create_buffer({.name = "down", .size = 256, .memory = Memory::readback}));
    ASSERT_NE(upload.mapped(), nullptr);
    ASSERT_NE(download.mapped(), nullptr);
    EXPECT_EQ(buffer(4).mapped(), nullptr);
    const std::vector<int32_t> values = ramp(64, 100);
    std::memcpy(upload.mapped(), values.data(), 256);
    Commands commands = device().begin();
    commands.pass("copy").copy(upload.slice(), download.slice());
    must(device().wait(device().submit(std::move(commands))));
    EXPECT_EQ(std::memcmp(download.mapped(), values.data(), 256), 0);
}

TEST_P(ComputeTest, BindingsPushConstantsUniformsAndOptionsArrive) {
    const std::vector<int32_t> values = ramp(1000, -500);
    Buffer source = buffer_with(values);
    Buffer target = buffer(4000);
    const auto plain = compute<scale>();
    const auto special = compute<scale>({.bias = -3, .negate = true, .shift = 2, .step = 5.5f});
    for (bool with_options : {false, true}) {
        Commands commands = device().begin();
        const UniformBuffer settings = commands.uniform(scale::Settings{.addend = {1, 20, 300, 4000}});
        commands.pass("scale").dispatch(
            with_options ? special : plain,
            {.Source = source.slice(), .settings = settings, .Target = target.slice()},
            {.count = 1000, .factor = -7, .pair = {3, 4}}, {groups_for(1000, 64)});
        device().submit(std::move(commands));
        std::vector<int32_t> expected;
        const int addend[] = {1, 20, 300, 4000};
        for (size_t i = 0; i < values.size(); ++i) {
            const int32_t value = values[i] * -7 + addend[i % 4] + 12;
            expected.push_back(with_options ? -(value - 3) * 4 + 5 : value + 1);
        }
        EXPECT_EQ(contents<int32_t>(target), expected);
    }
}

TEST_P(ComputeTest, SlicesBindPartsOfBuffers) {
    const uint64_t alignment = device().info().limits.storage_alignment;
    Buffer source = buffer_with(ramp(2048));
    Buffer target = buffer(4 * alignment + 64);
    Commands commands = device().begin();
    const UniformBuffer settings = commands.uniform(scale::Settings{});
    {
        Pass pass = commands.pass("slices");
        pass.fill(target.slice(), 0xffffffff);
        pass.dispatch(compute<scale>(),
                      {.Source = source.slice(alignment, 64),
                       .settings = settings,
                       .Target = target.slice(3 * alignment, 64)},
                      {.count = 16, .factor = 1, .pair = {0, 0}}, {1});
    }
    device().submit(std::move(commands));
    std::vector<int32_t> expected(target.size() / 4, -1);
    for (size_t i = 0; i < 16; ++i) expected[3 * alignment / 4 + i] = int32_t(alignment / 4 + i + 1);
    EXPECT_EQ(contents<int32_t>(target), expected);
}

TEST_P(ComputeTest, EachDispatchSeesTheOneBefore) {
    Buffer values = buffer(1 << 16);
    const auto step = compute<advance>();
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("steps");
        pass.fill(values.slice(), 1);
        for (int i = 0; i < 20; ++i) pass.dispatch(step, {values.slice()}, {}, {(1 << 14) / 64});
    }
    device().submit(std::move(commands));
    uint32_t expected = 1;
    for (int i = 0; i < 20; ++i) expected = expected * 3 + 1;
    EXPECT_THAT(contents<uint32_t>(values), Each(expected));
}

TEST_P(ComputeTest, AtomicsOfUnorderedDispatchesAddUp) {
    Buffer counters = buffer(7 * 4);
    const auto pipeline = compute<count>();
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("count");
        pass.fill(counters.slice());
        for (int i = 0; i < 10; ++i)
            pass.dispatch(pipeline, {counters.slice()}, {.counters = 7}, {.x = 49, .unordered = true});
    }
    device().submit(std::move(commands));
    EXPECT_THAT(contents<uint32_t>(counters), Each(10u * 49 * 64 / 7));
}

TEST_P(ComputeTest, GroupsComeFromTheDevice) {
    Buffer groups = buffer(64, BufferUsage::storage | BufferUsage::indirect);
    Buffer counters = buffer(4);
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("indirect");
        pass.fill(counters.slice());
        pass.dispatch(compute<arguments>(), {groups.slice()}, {.words = {99, 3, 5, 2}, .last = 0}, {});
        pass.dispatch_indirect(compute<count>(), {counters.slice()}, {.counters = 1}, groups.slice(4, 12));
        pass.dispatch(compute<arguments>(), {groups.slice()}, {.words = {0, 1, 1, 0}, .last = 0}, {});
        pass.dispatch_indirect(compute<count>(), {counters.slice()}, {.counters = 1}, groups.slice(0, 12));
    }
    device().submit(std::move(commands));
    EXPECT_THAT(contents<uint32_t>(counters), ElementsAre(3u * 5 * 2 * 64));
}

TEST_P(ComputeTest, PipelinesOutliveTheirOwnersWhileInFlight) {
    Buffer values = buffer(64 * 4);
    Commands commands = device().begin();
    {
        Pass pass = commands.pass("steps");
        pass.fill(values.slice(), 1);
        for (int i = 0; i < 3; ++i) pass.dispatch(compute<advance>(), {values.slice()}, {}, {1});
    }
    device().submit(std::move(commands));
    EXPECT_THAT(contents<uint32_t>(values), Each(40u));
}

}  // namespace
}  // namespace lumo::rhi
