// Frames in flight, lifetimes, pass times, misuse and choice of devices.
#include <cctype>
#include <chrono>
#include <glm/vec4.hpp>
#include <numeric>

#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/scale.hpp"
#include "shaders/test_rhi/several.hpp"
#include "shaders/test_rhi/spin.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using testing::Each;
using testing::HasSubstr;
using testing::SizeIs;

struct SubmissionTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Device, SubmissionTest, both_apis, api_name);

TEST_P(SubmissionTest, SerialsCountUpAndFinish) {
    Submission last;
    for (uint64_t i = 1; i <= 10; ++i) {
        Commands commands = device().begin();
        commands.pass("empty").end();
        last = device().submit(std::move(commands));
        EXPECT_EQ(last.serial, i);
    }
    must(device().wait(last));
    EXPECT_TRUE(device().finished(last));
}

TEST_P(SubmissionTest, ResourcesMayGoWhileFramesThatUseThemAreInFlight) {
    // Everything of a frame is made for it and dropped as soon as it is recorded; the memory is used again by
    // the next, so that an early destruction shows as wrong numbers or a message.
    constexpr uint32_t count = 4096;
    std::vector<Readback> tickets;
    for (uint32_t frame = 0; frame < 40; ++frame) {
        Commands commands = device().begin();
        Pass pass = commands.pass("frame");
        Buffer values = buffer(count * 4);
        Texture picture = texture({.name = "picture", .format = Format::r32_uint, .extent = {64, 64, 1}});
        const auto pipeline = compute<advance>();
        pass.fill(values.slice(), frame);
        for (int i = 0; i < 4; ++i) pass.dispatch(pipeline, {values.slice()}, {}, {count / 64});
        pass.clear(picture.view(), std::array<uint32_t, 4>{frame});
        tickets.push_back(pass.read(values.slice()));
        tickets.push_back(pass.read(picture, whole_mip(picture.desc())));
    }
    for (uint32_t frame = 0; frame < 40; ++frame) {
        uint32_t expected = frame;
        for (int i = 0; i < 4; ++i) expected = expected * 3 + 1;
        EXPECT_THAT(values_of<uint32_t>(must(device().take(tickets[2 * frame]))), Each(expected));
        EXPECT_THAT(values_of<uint32_t>(must(device().take(tickets[2 * frame + 1]))), Each(frame));
    }
}

TEST_P(SubmissionTest, StagedBytesSurviveTheRingsWrapping) {
    // 40 frames of 3 MiB of uploads and many uniforms: several times around the upload memory.
    const uint64_t size = uint64_t{3} << 20;
    Buffer target = buffer(size);
    Buffer source = buffer_with(std::vector<int32_t>(64, 1));
    Buffer sums = buffer(64 * 4);
    const auto pipeline = compute<scale>();
    std::vector<Readback> whole, scaled;
    for (int frame = 0; frame < 40; ++frame) {
        Commands commands = device().begin();
        Pass pass = commands.pass("frame");
        pass.upload(target.slice(), std::vector<std::byte>(size, std::byte(frame)));
        whole.push_back(pass.read(target.slice(size - 64, 64)));
        for (int i = 0; i < 50; ++i)
            pass.dispatch(pipeline,
                          {.Source = source.slice(),
                           .settings = commands.uniform(scale::Settings{glm::ivec4(1000 * frame + i)}),
                           .Target = sums.slice()},
                          {.count = 64, .factor = 1, .pair = {0, 0}}, {1});
        scaled.push_back(pass.read(sums.slice()));
    }
    for (int frame = 0; frame < 40; ++frame) {
        EXPECT_THAT(must(device().take(whole[size_t(frame)])), Each(std::byte(frame)));
        EXPECT_THAT(values_of<int32_t>(must(device().take(scaled[size_t(frame)]))),
                    Each(1000 * frame + 49 + 2));
    }
}

TEST_P(SubmissionTest, MemoryIsCountedAndGivenBack) {
    const auto total = [&] {
        const auto entries = device().memory();
        return std::accumulate(entries.begin(), entries.end(), uint64_t{0},
                               [](uint64_t sum, const MemoryEntry& entry) { return sum + entry.bytes; });
    };
    const uint64_t before = total();
    {
        Buffer large = buffer(1 << 20);
        Texture picture = texture({.name = "picture", .extent = {512, 512, 1}});
        EXPECT_GE(total(), before + (1 << 20) + 512 * 512 * 4);
        EXPECT_LE(total(), before + 2 * ((1 << 20) + 512 * 512 * 4));
    }
    EXPECT_EQ(total(), before);
}

double now_ms() {
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

TEST_P(SubmissionTest, PassTimesTellTheHeavyPassFromTheLightOne) {
    Texture target = texture({.name = "target",
                              .format = Format::rgba32_float,
                              .extent = {64, 64, 1},
                              .usage = TextureUsage::attachment});
    Texture which = texture({.name = "which",
                             .format = Format::rgba32_uint,
                             .extent = {64, 64, 1},
                             .usage = TextureUsage::attachment});
    Texture facing = texture({.name = "facing", .extent = {64, 64, 1}, .usage = TextureUsage::attachment});
    const auto draw = raster<several>({.color = {{.format = Format::rgba32_float},
                                                 {.format = Format::rgba32_uint},
                                                 {.format = Format::rgba8_unorm}}});
    const auto heavy = compute<spin>();
    Buffer result = buffer(64 * 64 * 4);
    const auto frame = [&](uint32_t rounds) {
        Commands commands = device().begin();
        {
            RasterPass pass = commands.raster_pass(
                "light",
                {.color = {{.view = target.view()}, {.view = which.view()}, {.view = facing.view()}}});
            pass.draw(draw, {}, {}, Draw{.vertices = 3});
        }
        commands.pass("heavy").dispatch(heavy, {result.slice()}, {.rounds = rounds}, {64});
        commands.pass("after").fill(result.slice());
        return device().submit(std::move(commands));
    };
    must(device().wait(frame(1)));  // pipelines are made lazily by some drivers

    const double start = now_ms();
    const Submission submission = frame(40);
    must(device().wait(submission));
    const double wall = now_ms() - start;
    const auto times = device().pass_times(submission);
    ASSERT_THAT(times, SizeIs(3));
    EXPECT_EQ(times[0].name, "light");
    EXPECT_EQ(times[1].name, "heavy");
    EXPECT_EQ(times[2].name, "after");
    const double sum = times[0].milliseconds + times[1].milliseconds + times[2].milliseconds;
    for (const PassTime& time : times) EXPECT_GE(time.milliseconds, 0);
    EXPECT_GT(times[1].milliseconds, sum / 2);
    if (device().info().timing == Timing::serialised) {
        EXPECT_LE(sum, wall);
        EXPECT_GT(sum, wall / 2) << "the work is nearly all of it";
    }
}

TEST_P(SubmissionTest, SoftwareDevicesTimePassesOneAfterTheOther) {
    if (device().info().software) {
        EXPECT_EQ(device().info().timing, Timing::serialised);
    }
    EXPECT_NE(device().info().timing, Timing::automatic);
    auto overlapped = open_device(GetParam(), {.timing = Timing::overlapped});
    ASSERT_TRUE(overlapped);
    EXPECT_EQ(overlapped->device->info().timing, Timing::overlapped);
}

TEST_P(SubmissionTest, MisuseIsNamedAndDoesNotReachTheDriver) {
    Buffer small = buffer(64);
    Texture picture = texture({.name = "picture", .extent = {8, 8, 1}, .mips = 2});
    const auto pipeline = compute<advance>();
    std::vector<Check> expected;
    {
        Commands commands = device().begin();
        Pass pass = commands.pass("wrong");
        const auto wrong = [&](Check check) { expected.push_back(check); };
        pass.dispatch(pipeline, {small.slice(0, 65)}, {}, {1});
        wrong(Check::buffer_out_of_range);
        pass.dispatch(pipeline, {small.slice()}, {}, {0});
        wrong(Check::empty_work);
        pass.dispatch(pipeline, {small.slice()}, {}, {device().info().limits.max_groups[0], 1, 0xffffffff});
        wrong(Check::work_too_large);
        pass.dispatch(pipeline, {BufferSlice{}}, {}, {1});
        wrong(Check::stale_handle);
        pass.clear(picture.view({.first_mip = 1, .mips = 2}));
        wrong(Check::view_out_of_range);
        pass.copy(small.slice(0, 32), small.slice(16, 32));
        wrong(Check::copy_overlap);
        (void)pass.read(picture, {.mip = 1, .extent = {5, 4, 1}});
        wrong(Check::copy_out_of_range);
        Pass second = commands.pass("second");
        wrong(Check::pass_open);
    }
    std::vector<Check> said;
    for (const Message& message : take_failures()) {
        said.push_back(message.check);
        EXPECT_FALSE(message.text.empty());
    }
    EXPECT_EQ(said, expected);
    // And the device goes on.
    must(device().upload(small.slice(), std::vector<std::byte>(64, std::byte{1})));
    run(pipeline, {small.slice()}, {}, {1});
    EXPECT_THAT(contents<uint32_t>(small), Each(0x01010101u * 3 + 1));
}

TEST_P(SubmissionTest, WhatTheDeviceCannotHoldIsAnError) {
    const auto made = device().create_buffer({.name = "everything", .size = uint64_t{1} << 45});
    ASSERT_FALSE(made);
    EXPECT_TRUE(made.error().kind == ErrorKind::out_of_memory || made.error().kind == ErrorKind::unsupported)
        << to_string(made.error());
    EXPECT_FALSE(device().create_texture({.name = "wide", .extent = {1u << 20, 1, 1}}));
    take_failures();  // drivers may mention it
    Buffer small = buffer(4);
    must(device().upload(small.slice(), std::vector<std::byte>(4)));
}

TEST_P(SubmissionTest, DevicesShareNothing) {
    auto other = open_device(GetParam());
    ASSERT_TRUE(other);
    Buffer mine = buffer(1024);
    Buffer theirs = must(other->device->create_buffer({.name = "theirs", .size = 1024}));
    for (uint32_t i = 0; i < 4; ++i) {
        Commands here = device().begin();
        Commands there = other->device->begin();
        Pass a = here.pass("here");
        Pass b = there.pass("there");
        a.fill(mine.slice(), i);
        b.fill(theirs.slice(), 100 + i);
    }
    EXPECT_THAT(contents<uint32_t>(mine), Each(3u));
    EXPECT_THAT(values_of<uint32_t>(must(other->device->download(theirs.slice()))), Each(103u));
    theirs = {};
    other->device.reset();
    EXPECT_THAT(contents<uint32_t>(mine), Each(3u)) << "one goes, the other stays";
    EXPECT_TRUE(other->take_failures().empty());
}

TEST_P(SubmissionTest, ADeviceIsFoundByPartOfItsNameAndNoOtherIsTaken) {
    std::string part = device().info().name.substr(0, 5);
    for (char& c : part) c = char(std::toupper(c));
    DeviceDesc desc{.name = part};
    auto named = backends::create_device(GetParam(), desc);
    ASSERT_TRUE(named) << to_string(named.error());
    EXPECT_EQ(named->info().name, device().info().name);

    auto refused = backends::create_device(GetParam(), {.name = "no such device"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::no_device);
    EXPECT_THAT(to_string(refused.error()), HasSubstr("no such device"));
    EXPECT_THAT(to_string(refused.error()), HasSubstr(device().info().name)) << "it says what there is";
}

TEST_P(SubmissionTest, TheDeviceSaysWhatItIs) {
    const DeviceInfo& info = device().info();
    EXPECT_EQ(info.api, GetParam());
    EXPECT_FALSE(info.name.empty());
    EXPECT_FALSE(info.driver.empty());
    EXPECT_FALSE(info.api_version.empty());
    EXPECT_TRUE(info.validation);
    EXPECT_GE(info.limits.max_texture_side_2d, 4096u);
    EXPECT_GE(info.limits.max_texture_side_3d, 512u);
    EXPECT_GE(info.limits.max_storage_bytes, uint64_t{1} << 27);
    EXPECT_GE(info.limits.max_uniform_bytes, 16384u);
    const auto all = backends::list_devices(GetParam());
    EXPECT_TRUE(std::ranges::any_of(all, [&](const DeviceInfo& one) { return one.name == info.name; }));
}

// -- both APIs at once

/// A bit of everything, recorded on `device`; the traces of its submissions.
std::string trace_of(Device& device) {
    device.set_tracing(true);
    const auto buffer = [&](std::string name, BufferUsage usage = BufferUsage::storage) {
        return must(device.create_buffer({.name = std::move(name), .size = 16384, .usage = usage}));
    };
    Buffer values = buffer("values"), sums = buffer("sums");
    const TextureUsage use = TextureUsage::attachment | TextureUsage::sampled;
    Texture where = must(device.create_texture(
        {.name = "where", .format = Format::rgba32_float, .extent = {32, 32, 1}, .mips = 3, .usage = use}));
    Texture which = must(device.create_texture(
        {.name = "which", .format = Format::rgba32_uint, .extent = {32, 32, 1}, .usage = use}));
    Texture facing = must(device.create_texture({.name = "facing", .extent = {32, 32, 1}, .usage = use}));
    const auto step = must(device.create_compute_pipeline<advance>());
    const auto multiply = must(device.create_compute_pipeline<scale>());
    const auto draw =
        must(device.create_raster_pipeline<several>({.color = {{.format = Format::rgba32_float},
                                                               {.format = Format::rgba32_uint},
                                                               {.format = Format::rgba8_unorm}}}));
    std::string trace;
    for (int frame = 0; frame < 4; ++frame) {
        // Names and lifetimes that a device may let go of sooner or later.
        Buffer passing = buffer("passing");
        Commands commands = device.begin();
        {
            Pass pass = commands.pass("compute");
            pass.upload(values.slice(), std::vector<std::byte>(16384, std::byte(frame)));
            for (int i = 0; i < 3; ++i) pass.dispatch(step, {values.slice()}, {}, {64});
            pass.dispatch(multiply,
                          {.Source = values.slice(),
                           .settings = commands.uniform(scale::Settings{}),
                           .Target = sums.slice()},
                          {.count = 4096, .factor = 2, .pair = {0, 0}}, {64});
            pass.copy(sums.slice(), passing.slice());
        }
        {
            RasterPass pass =
                commands.raster_pass("raster", {.color = {{.view = where.mip<d2>(0)},
                                                          {.view = which.view()},
                                                          {.view = facing.view(), .load = Load::keep}}});
            pass.draw(draw, {}, {}, Draw{.vertices = 3});
        }
        {
            Pass pass = commands.pass("copies");
            pass.generate_mips(where);
            pass.copy(which, whole_mip(which.desc()), where, whole_mip(where.desc()));
            pass.clear(facing.view());
            (void)pass.read(passing.slice());
            (void)pass.read(where, whole_mip(where.desc(), 1));
        }
        trace += device.trace(device.submit(std::move(commands)));
    }
    return trace;
}

TEST(BothApis, GetTheSameBarriers) {
    auto gl = open_device(Api::gl);
    auto vulkan = open_device(Api::vulkan);
    if (!gl || !vulkan) GTEST_SKIP() << "one of the APIs finds no device";
    const std::string first = trace_of(*gl->device);
    EXPECT_EQ(first, trace_of(*vulkan->device));
    EXPECT_THAT(first, HasSubstr("compute/test_rhi/advance: \"values\" storage_read|storage_write@compute\n"
                                 "    \"values\": copy_write -> storage_read|storage_write@compute\n"));
    for (CheckedDevice* checked : {&*gl, &*vulkan}) {
        checked->device.reset();
        for (const Message& failure : checked->take_failures()) ADD_FAILURE() << failure.text;
    }
}

}  // namespace
}  // namespace lumo::rhi
