// The core of the RHI on a device without an API: submissions, lifetimes, staging, readback, barriers, errors.
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>

#include "tests/unit/rhi_fake_backend.hpp"
#include "tests/unit/rhi_fake_programs.hpp"

namespace lumo::rhi {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

struct Core : testing::Test {
    fake::State state;
    std::vector<Message> messages;
    std::optional<Device> device;

    Core() { make(); }
    void make() {
        device.emplace(std::make_unique<fake::FakeBackend>(state),
                       DeviceDesc{.sink = [this](const Message& message) { messages.push_back(message); }});
    }

    Buffer buffer(std::string name, uint64_t size = 256, BufferUsage usage = BufferUsage::storage) {
        return std::move(
            device->create_buffer({.name = std::move(name), .size = size, .usage = usage}).value());
    }
    Texture texture(const TextureDesc& desc) { return std::move(device->create_texture(desc).value()); }
    template <class P>
    ComputePipeline<P> compute() {
        return std::move(device->create_compute_pipeline<P>().value());
    }
    RasterPipeline<fake::Paint> paint() {
        return std::move(
            device->create_raster_pipeline<fake::Paint>({.color = {{.format = Format::rgba8_unorm}}})
                .value());
    }
    std::vector<Check> checks() const {
        std::vector<Check> all;
        for (const Message& message : messages) all.push_back(message.check);
        return all;
    }
};

std::vector<std::byte> ramp(size_t size) {
    std::vector<std::byte> bytes(size);
    for (size_t i = 0; i < size; ++i) bytes[i] = std::byte(i * 7 + i / 251);
    return bytes;
}

// -- lifetimes

TEST_F(Core, OwnersDestroyAtOnceWhatTheDeviceDoesNotUse) {
    { Buffer mine = buffer("mine"); }
    EXPECT_THAT(state.destroyed, ElementsAre("mine"));
    EXPECT_EQ(state.alive(), 0u);
}

TEST_F(Core, WhatASubmissionInFlightMayUseIsDestroyedAfterIt) {
    state.finish_at_once = false;
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    commands.pass("fill").fill(mine.slice());
    const Submission submission = device->submit(std::move(commands));
    mine = {};
    EXPECT_THAT(state.destroyed, IsEmpty());
    EXPECT_FALSE(device->finished(submission));
    ASSERT_TRUE(device->wait(submission));
    EXPECT_THAT(state.destroyed, ElementsAre("mine"));
}

TEST_F(Core, WhatAnOpenPassUsesIsDestroyedAfterItsSubmission) {
    Commands commands = device->begin();
    {
        Pass pass = commands.pass("fill");
        Buffer mine = buffer("mine");
        pass.fill(mine.slice());
    }
    EXPECT_THAT(state.destroyed, IsEmpty());
    device->submit(std::move(commands));
    (void)device->begin();
    EXPECT_THAT(state.destroyed, ElementsAre("mine"));
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Core, AnIndexIsUsedAgainOnlyWhenItsResourceIsGone) {
    state.finish_at_once = false;
    Buffer first = buffer("first");
    const BufferHandle old = first.handle();
    Commands commands = device->begin();
    commands.pass("fill").fill(first.slice());
    const Submission submission = device->submit(std::move(commands));
    first = {};
    Buffer second = buffer("second");
    EXPECT_NE(second.handle().index, old.index);
    ASSERT_TRUE(device->wait(submission));
    Buffer third = buffer("third");
    EXPECT_EQ(third.handle().index, old.index);
    EXPECT_NE(third.handle().generation, old.generation);
}

TEST_F(Core, EmptyAndMovedOwnersAreHarmless) {
    Buffer empty;
    EXPECT_FALSE(empty);
    Texture picture;
    Sampler sampler;
    ComputePipeline<fake::Store> pipeline;
    Buffer mine = buffer("mine");
    Buffer taken = std::move(mine);
    EXPECT_TRUE(taken);
    EXPECT_FALSE(mine);  // NOLINT(bugprone-use-after-move): what is left is the point
    mine = std::move(taken);
    EXPECT_TRUE(mine);
    EXPECT_THAT(state.destroyed, IsEmpty());
}

TEST_F(Core, LeaksAreReportedByNameAndDestroyed) {
    Buffer left = buffer("left");
    Texture picture = texture({.name = "picture"});
    Sampler sampler = std::move(device->create_sampler({}).value());
    ComputePipeline<fake::Store> pipeline = compute<fake::Store>();
    device.reset();
    EXPECT_THAT(checks(), UnorderedElementsAre(Check::leaked_resource, Check::leaked_resource,
                                               Check::leaked_resource, Check::leaked_resource));
    EXPECT_THAT(messages, Contains(Field(&Message::text, HasSubstr("texture \"picture\""))));
    EXPECT_EQ(state.alive(), 0u) << "and the owners that are left do not reach into what is gone";
}

TEST_F(Core, ADeviceThatOwnsNothingLeavesNothing) {
    {
        Buffer mine = buffer("mine");
        Commands commands = device->begin();
        Pass pass = commands.pass("all");
        pass.upload(mine.slice(), ramp(256));
        (void)pass.read(mine.slice());
        (void)commands.uniform(1.0f);
    }
    device.reset();
    EXPECT_THAT(messages, IsEmpty());
    EXPECT_EQ(state.alive(), 0u);
}

TEST_F(Core, HandlesOfAnotherDeviceAreStale) {
    fake::State other_state;
    Device other(std::make_unique<fake::FakeBackend>(other_state), {.sink = [](const Message&) {}});
    Buffer theirs = std::move(other.create_buffer({.name = "theirs", .size = 256}).value());
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    commands.pass("fill").fill(theirs.slice());
    EXPECT_THAT(checks(), ElementsAre(Check::stale_handle));
}

TEST_F(Core, MemoryIsListedLargestFirst) {
    Buffer small = buffer("small", 100);
    Texture large = texture({.name = "large", .extent = {64, 64, 1}});
    const auto entries = device->memory();
    ASSERT_THAT(entries, SizeIs(2));
    EXPECT_EQ(entries[0].name, "large");
    EXPECT_EQ(entries[0].bytes, 64u * 64 * 4);
    EXPECT_EQ(entries[1].bytes, 100u);
    small = {};
    EXPECT_THAT(device->memory(), SizeIs(1));
}

// -- staging

TEST_F(Core, UploadsArriveAndDownloadsReturn) {
    Buffer mine = buffer("mine", 1000);
    const auto bytes = ramp(600);
    ASSERT_TRUE(device->upload(mine.slice(200, 600), bytes));
    EXPECT_EQ(device->download(mine.slice(200, 600)).value(), bytes);
    EXPECT_EQ(device->download(mine.slice(0, 200)).value(), std::vector<std::byte>(200));
}

TEST_F(Core, UploadsOfAFrameInFlightAreNotOverwritten) {
    // Frames of 5, 9 and 13 MiB pass the end of a 16 MiB block while two of them are in flight.
    state.finish_at_once = false;
    Buffer mine = buffer("mine", uint64_t{13} << 20);
    std::vector<BufferSlice> sources;
    for (int frame = 0; frame < 12; ++frame) {
        const auto size = uint64_t(5 + 4 * (frame % 3)) << 20;
        Commands commands = device->begin();
        commands.pass("upload").upload(mine.slice(0, size), std::vector<std::byte>(size, std::byte(frame)));
        const BufferSlice source = std::get<CopyBufferCommand>(state.passes.back().commands[0]).source;
        sources.push_back(source);
        device->submit(std::move(commands));
        for (int other = std::max(0, frame - int(max_in_flight) + 1); other <= frame; ++other) {
            const BufferSlice& slice = sources[size_t(other)];
            const auto& bytes = state.buffers.at(slice.buffer.index);
            for (uint64_t at : {slice.offset, slice.offset + slice.size - 1})
                EXPECT_EQ(bytes[at], std::byte(other)) << "frame " << frame << " wrote over frame " << other;
        }
    }
    uint64_t staging = 0;
    for (const MemoryEntry& entry : device->memory())
        if (entry.name == "staging") staging += entry.bytes;
    EXPECT_LE(staging, uint64_t{64} << 20) << "blocks are used again";
}

TEST_F(Core, AnUploadLargerThanABlockHasItsOwnAndGivesItBack) {
    const uint64_t size = (uint64_t{16} << 20) + 4;
    Buffer mine = buffer("mine", size);
    const auto bytes = ramp(size);
    ASSERT_TRUE(device->upload(mine.slice(), bytes));
    EXPECT_EQ(device->download(mine.slice()).value(), bytes);
    for (int i = 0; i < 8; ++i) ASSERT_TRUE(device->upload(mine.slice(0, 8 << 20), ramp(8 << 20)));
    uint64_t staging = 0;
    for (const MemoryEntry& entry : device->memory())
        if (entry.name == "staging") staging += entry.bytes;
    EXPECT_LE(staging, uint64_t{32} << 20);
}

TEST_F(Core, TransientUniformsAreAlignedApartAndHoldTheirBytes) {
    Buffer source = buffer("source");
    Buffer counter = buffer("counter");
    auto pipeline = compute<fake::Count>();
    Commands commands = device->begin();
    const UniformBuffer first = commands.uniform(std::array<uint32_t, 4>{1, 2, 3, 4});
    const UniformBuffer second = commands.uniform(std::array<uint32_t, 4>{5, 6, 7, 8});
    EXPECT_EQ(first.slice.offset % state.info.limits.uniform_alignment, 0u);
    EXPECT_EQ(second.slice.offset % state.info.limits.uniform_alignment, 0u);
    EXPECT_NE(first.slice, second.slice);
    {
        Pass pass = commands.pass("count");
        pass.dispatch(pipeline, {source.slice(), counter.slice(), first}, {}, {});
        pass.dispatch(pipeline, {source.slice(), counter.slice(), second}, {}, {.unordered = true});
    }
    EXPECT_THAT(messages, IsEmpty());
    const BufferSlice bound = state.passes[0].bindings[1][2].slice;
    uint32_t word = 0;
    std::memcpy(&word, state.buffers.at(bound.buffer.index).data() + bound.offset, sizeof(word));
    EXPECT_EQ(word, 5u);
}

TEST_F(Core, TransientUniformsEndWithTheirSubmission) {
    Buffer source = buffer("source");
    Buffer counter = buffer("counter");
    auto pipeline = compute<fake::Count>();
    std::optional<UniformBuffer> kept;
    for (int frame = 0; frame < 3; ++frame) {
        Commands commands = device->begin();
        const UniformBuffer fresh = commands.uniform(std::array<float, 4>{});
        Pass pass = commands.pass("count");
        pass.dispatch(pipeline, {source.slice(), counter.slice(), fresh}, {}, {});
        EXPECT_THAT(messages, IsEmpty());
        if (kept) pass.dispatch(pipeline, {source.slice(), counter.slice(), *kept}, {}, {});
        EXPECT_THAT(checks(), SizeIs(kept ? 1 : 0));
        messages.clear();
        kept = fresh;
    }
}

TEST_F(Core, PushConstantsAreCopiedWhenTheyAreGiven) {
    Buffer mine = buffer("mine");
    auto pipeline = compute<fake::Store>();
    Commands commands = device->begin();
    {
        Pass pass = commands.pass("store");
        for (uint32_t i = 0; i < 100; ++i) {
            fake::Store::Push push{i, 2 * i};
            pass.dispatch(pipeline, {mine.slice()}, push, {});
            push = {};
        }
    }
    ASSERT_THAT(state.passes[0].pushes, SizeIs(100));
    for (uint32_t i = 0; i < 100; ++i) {
        fake::Store::Push push{};
        std::memcpy(&push, state.passes[0].pushes[i].data(), sizeof(push));
        EXPECT_EQ(push.first, i);
        EXPECT_EQ(push.second, 2 * i);
    }
}

// -- readback

TEST_F(Core, ATicketIsTakenOnce) {
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    Readback ticket;
    {
        Pass pass = commands.pass("read");
        pass.fill(mine.slice(), 0x01020304);
        ticket = pass.read(mine.slice(0, 4));
        pass.fill(mine.slice(), 0);
    }
    EXPECT_FALSE(device->take(ticket)) << "not submitted yet";
    EXPECT_THAT(checks(), ElementsAre(Check::ticket_unknown));
    device->submit(std::move(commands));
    const auto bytes = device->take(ticket);
    ASSERT_TRUE(bytes);
    EXPECT_THAT(*bytes, ElementsAre(std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}));
    EXPECT_FALSE(device->take(ticket));
    EXPECT_FALSE(device->take(Readback{}));
    EXPECT_THAT(checks(), SizeIs(3));
    EXPECT_THAT(checks(), Each(Check::ticket_unknown));
}

TEST_F(Core, ReadbackMemoryIsUsedAgainButNotWhileATicketHoldsIt) {
    Buffer mine = buffer("mine", 4096);
    Commands commands = device->begin();
    std::vector<Readback> tickets;
    {
        Pass pass = commands.pass("read");
        for (uint32_t i = 0; i < 4; ++i) {
            pass.fill(mine.slice(), i);
            tickets.push_back(pass.read(mine.slice()));
        }
    }
    device->submit(std::move(commands));
    for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(device->take(tickets[i]).value()[0], std::byte(i));
    const size_t buffers = state.buffers.size();
    for (int i = 0; i < 8; ++i) ASSERT_TRUE(device->download(mine.slice()));
    EXPECT_EQ(state.buffers.size(), buffers);
}

// -- submissions

TEST_F(Core, CommandsThatGoOutOfScopeAreSubmitted) {
    { Commands commands = device->begin(); }
    EXPECT_EQ(state.submitted, 1u);
    EXPECT_TRUE(device->wait({1}));
}

TEST_F(Core, OneSubmissionAndOnePassAreOpenAtATime) {
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    {
        Commands second = device->begin();
        EXPECT_THAT(checks(), ElementsAre(Check::pass_open));
        EXPECT_FALSE(device->upload(mine.slice(), ramp(256)));
        Pass pass = commands.pass("first");
        Pass other = commands.pass("second");
        other.fill(mine.slice());
        pass.fill(mine.slice());
    }
    EXPECT_THAT(checks(), ElementsAre(Check::pass_open, Check::pass_open, Check::pass_open));
    EXPECT_EQ(state.submitted, 0u);
    ASSERT_THAT(state.passes, SizeIs(1));
    EXPECT_EQ(state.passes[0].name, "first");
    EXPECT_THAT(state.passes[0].commands, SizeIs(1));
}

TEST_F(Core, SubmittingWithAnOpenPassEndsIt) {
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    Pass pass = commands.pass("open");
    pass.fill(mine.slice());
    device->submit(std::move(commands));
    EXPECT_THAT(checks(), ElementsAre(Check::pass_open));
    ASSERT_THAT(state.passes, SizeIs(1));
    pass.fill(mine.slice());
    EXPECT_THAT(checks(), ElementsAre(Check::pass_open, Check::commands_spent));
}

TEST_F(Core, CommandsAreSpentBySubmission) {
    Commands commands = device->begin();
    const Submission submission = device->submit(std::move(commands));
    // NOLINTBEGIN(bugprone-use-after-move): the mistake that the check is for
    Pass pass = commands.pass("late");
    (void)commands.uniform(1);
    EXPECT_EQ(device->submit(std::move(commands)).serial, 0u);
    // NOLINTEND(bugprone-use-after-move)
    EXPECT_THAT(checks(), ElementsAre(Check::commands_spent, Check::commands_spent, Check::commands_spent));
    EXPECT_THAT(state.passes, IsEmpty());
    EXPECT_TRUE(device->wait(submission));
}

TEST_F(Core, AnEndedPassTakesNoMore) {
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    Pass pass = commands.pass("done");
    pass.end();
    pass.end();
    pass.fill(mine.slice());
    EXPECT_THAT(checks(), ElementsAre(Check::commands_spent));
}

TEST_F(Core, WaitingForWhatWasNotSubmittedIsAnError) {
    EXPECT_FALSE(device->wait({1}));
    EXPECT_TRUE(device->wait({0}));
}

TEST_F(Core, PassTimesCarryNamesInOrder) {
    Buffer mine = buffer("mine");
    Commands commands = device->begin();
    commands.pass("one").fill(mine.slice());
    {
        Pass pass = commands.pass("two");
        pass.fill(mine.slice());
        pass.fill(mine.slice());
    }
    const auto times = device->pass_times(device->submit(std::move(commands)));
    ASSERT_THAT(times, SizeIs(2));
    EXPECT_EQ(times[0].name, "one");
    EXPECT_EQ(times[1].name, "two");
    EXPECT_DOUBLE_EQ(times[0].milliseconds, 1.0);
    EXPECT_DOUBLE_EQ(times[1].milliseconds, 1.5);
}

TEST_F(Core, PassTimesAreKeptForSixteenSubmissions) {
    const auto submit = [&] {
        Commands commands = device->begin();
        commands.pass("pass").end();
        return device->submit(std::move(commands));
    };
    const Submission first = submit();
    for (int i = 0; i < 15; ++i) submit();
    EXPECT_THAT(device->pass_times(first), SizeIs(1));
    submit();
    EXPECT_THAT(device->pass_times(first), IsEmpty());
}

// -- barriers as the backend gets them

TEST_F(Core, EveryDispatchIsItsOwnScope) {
    Buffer mine = buffer("mine");
    auto pipeline = compute<fake::Store>();
    Commands commands = device->begin();
    {
        Pass pass = commands.pass("store");
        for (int i = 0; i < 3; ++i) pass.dispatch(pipeline, {mine.slice()}, {}, {});
    }
    EXPECT_THAT(state.passes[0].step_barriers, ElementsAre(IsEmpty(), SizeIs(1), SizeIs(1)));
}

TEST_F(Core, BarriersReachAcrossSubmissions) {
    Buffer mine = buffer("mine");
    for (int i = 0; i < 2; ++i) {
        Commands commands = device->begin();
        commands.pass("fill").fill(mine.slice());
    }
    EXPECT_THAT(state.passes[0].step_barriers[0], IsEmpty());
    EXPECT_THAT(state.passes[1].step_barriers[0], SizeIs(1));
}

TEST_F(Core, TheCoresOwnMemoryTakesNoBarriers) {
    Buffer mine = buffer("mine");
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(device->upload(mine.slice(), ramp(256)));
        ASSERT_TRUE(device->download(mine.slice()));
        Commands commands = device->begin();
        commands.pass("copy").copy(commands.uniform(1.0f).slice, mine.slice(0, 4));
    }
    EXPECT_THAT(messages, IsEmpty());
    for (const auto& pass : state.passes)
        for (const auto& barriers : pass.step_barriers)
            for (const Barrier& barrier : barriers) EXPECT_EQ(barrier.memory.index, mine.handle().index);
}

TEST_F(Core, ARasterPassWaitsOnceInFront) {
    Buffer vertices = buffer("vertices");
    Buffer list = buffer("list");
    Buffer counter = buffer("counter");
    Texture target = texture({.name = "target", .extent = {8, 8, 1}, .usage = TextureUsage::attachment});
    auto pipeline = paint();
    ASSERT_TRUE(device->upload(vertices.slice(), ramp(256)));
    Commands commands = device->begin();
    {
        RasterPass pass = commands.raster_pass("paint", {.color = {{.view = target.view<Dimension::d2>()}}});
        for (int i = 0; i < 3; ++i)
            pass.draw(pipeline, {vertices.slice(), list.slice(), counter.slice()}, {}, Draw{.vertices = 3});
    }
    EXPECT_THAT(messages, IsEmpty());
    const fake::Emitted& pass = state.passes.back();
    EXPECT_TRUE(pass.raster);
    EXPECT_EQ(pass.extent, (Extent{8, 8, 1}));
    EXPECT_THAT(pass.barriers, SizeIs(2)) << "the vertices, and the target from undefined";
    EXPECT_THAT(pass.step_barriers, SizeIs(3));
    EXPECT_THAT(pass.step_barriers, Each(IsEmpty()));
}

TEST_F(Core, ATextureAtAnotherOnesPlaceStartsUndefined) {
    for (int i = 0; i < 2; ++i) {
        Texture picture = texture({.name = "picture", .extent = {8, 8, 1}});
        EXPECT_EQ(picture.handle().index, 0u);
        Commands commands = device->begin();
        commands.pass("clear").clear(picture.view());
        ASSERT_THAT(state.passes.back().step_barriers[0], SizeIs(1));
        EXPECT_EQ(state.passes.back().step_barriers[0][0].before, Access::none);
    }
}

TEST_F(Core, WhatIsNotOverwrittenIsNotDiscarded) {
    Texture layers = texture({.name = "layers",
                              .dimension = Dimension::d2_array,
                              .extent = {8, 8, 1},
                              .layers = 2,
                              .usage = TextureUsage::attachment});
    const auto discards = [&](ViewRange range, Load load) {
        Commands commands = device->begin();
        commands.raster_pass("draw", {.color = {{.view = layers.view(range), .load = load}}}).end();
        return state.passes.back().barriers.at(0).discard;
    };
    EXPECT_TRUE(discards({}, Load::clear));
    EXPECT_TRUE(discards({}, Load::discard));
    EXPECT_FALSE(discards({}, Load::keep));
    EXPECT_FALSE(discards({.first_layer = 1, .layers = 1}, Load::clear)) << "the other layer stays";
    const auto uploads = [&](TextureRegion region) {
        Commands commands = device->begin();
        commands.pass("upload").upload(layers, region, ramp(region_bytes(Format::rgba8_unorm, region)));
        return state.passes.back().step_barriers.at(0).at(0).discard;
    };
    EXPECT_TRUE(uploads({.layers = 2, .extent = {8, 8, 1}}));
    EXPECT_FALSE(uploads({.layers = 1, .extent = {8, 8, 1}}));
    EXPECT_FALSE(uploads({.layers = 2, .extent = {8, 7, 1}}));
}

TEST_F(Core, MipsAreFilteredOneFromTheOther) {
    Texture picture = texture({.name = "picture", .extent = {8, 8, 1}, .mips = 4});
    Commands commands = device->begin();
    commands.pass("mips").generate_mips(picture);
    const fake::Emitted& pass = state.passes.back();
    ASSERT_THAT(pass.commands, SizeIs(3));
    EXPECT_EQ(std::get<BlitMipCommand>(pass.commands[2]).source_mip, 2u);
    // Mip 1 was written, then is read.
    EXPECT_THAT(pass.step_barriers[1], Contains(Field(&Barrier::before_layout, Layout::copy_destination)));
}

TEST_F(Core, TheTraceNamesPassesProgramsAndResources) {
    Buffer mine = buffer("mine");
    auto pipeline = compute<fake::Store>();
    const auto record = [&] {
        Commands commands = device->begin();
        {
            Pass pass = commands.pass("frame");
            pass.fill(mine.slice());
            pass.dispatch(pipeline, {mine.slice()}, {}, {});
        }
        return device->submit(std::move(commands));
    };
    EXPECT_EQ(device->trace(record()), "") << "while tracing is off";
    device->set_tracing(true);
    EXPECT_EQ(device->trace(record()),
              "frame/fill: \"mine\" copy_write\n"
              "    \"mine\": storage_write@compute -> copy_write\n"
              "frame/fake/store: \"mine\" storage_write@compute\n"
              "    \"mine\": copy_write -> storage_write@compute\n");
}

TEST_F(Core, TheTraceDoesNotDependOnWhenTheDeviceLetsGo) {
    std::vector<std::string> traces;
    for (bool finish : {true, false}) {
        device.reset();
        state = {};
        state.finish_at_once = finish;
        make();
        device->set_tracing(true);
        std::string all;
        Buffer a = buffer("a"), b;
        for (int i = 0; i < 6; ++i) {
            Commands commands = device->begin();
            b = buffer("b");
            {
                Pass pass = commands.pass("frame");
                pass.fill(b.slice());
                pass.copy(b.slice(), a.slice());
            }
            all += device->trace(device->submit(std::move(commands)));
        }
        traces.push_back(all);
        a = {};
        b = {};
        device.reset();
    }
    EXPECT_EQ(traces[0], traces[1]);
}

// -- what the environment refuses

TEST_F(Core, AFailedCreationLeavesNothingBehind) {
    const Error error{ErrorKind::out_of_memory, "device", "no memory", ""};
    state.failing = {{"create_buffer", error},
                     {"create_texture", error},
                     {"create_sampler", error},
                     {"create_pipeline", {ErrorKind::shader, "program", "does not link", ""}}};
    EXPECT_EQ(device->create_buffer({.size = 4}).error().kind, ErrorKind::out_of_memory);
    EXPECT_EQ(device->create_texture({}).error().kind, ErrorKind::out_of_memory);
    EXPECT_EQ(device->create_sampler({}).error().kind, ErrorKind::out_of_memory);
    EXPECT_EQ(device->create_compute_pipeline<fake::Store>().error().kind, ErrorKind::shader);
    EXPECT_THAT(device->memory(), IsEmpty());
    device.reset();
    EXPECT_THAT(messages, IsEmpty()) << "no leak of what never was";
}

TEST_F(Core, NoMemoryForStagingIsAnErrorAndAMessage) {
    Buffer mine = buffer("mine");
    state.failing = {{"create_buffer", {ErrorKind::out_of_memory, "device", "no memory", ""}}};
    const auto uploaded = device->upload(mine.slice(), ramp(256));
    ASSERT_FALSE(uploaded);
    EXPECT_EQ(uploaded.error().kind, ErrorKind::out_of_memory);
    state.failing = {{"create_buffer", {ErrorKind::out_of_memory, "device", "no memory", ""}}};
    EXPECT_FALSE(device->download(mine.slice()));
    ASSERT_THAT(messages, SizeIs(2));
    EXPECT_EQ(messages[0].check, Check::none);
    EXPECT_TRUE(is_failure(messages[0]));
    EXPECT_TRUE(device->upload(mine.slice(), ramp(256))) << "the device goes on";
}

TEST_F(Core, ALostDeviceIsSaidOnceAndEveryWaitSaysSo) {
    Buffer mine = buffer("mine");
    state.failing = {{"submit", {ErrorKind::device_lost, "device", "lost", ""}}};
    EXPECT_EQ(device->upload(mine.slice(), ramp(256)).error().kind, ErrorKind::device_lost);
    EXPECT_EQ(device->download(mine.slice()).error().kind, ErrorKind::device_lost);
    EXPECT_THAT(messages, SizeIs(1));
    const size_t passes = state.passes.size();
    device->begin().pass("after").fill(mine.slice());
    EXPECT_EQ(state.passes.size(), passes) << "nothing is recorded any more";
    mine = {};
    device.reset();
    EXPECT_EQ(state.alive(), 0u);
}

TEST_F(Core, AnisotropyIsClampedToTheDevices) {
    Sampler sampler = std::move(device->create_sampler({.max_anisotropy = 64}).value());
    EXPECT_EQ(state.sampler_descs.back().max_anisotropy, 8.0f);
    EXPECT_FALSE(device->create_sampler({.max_anisotropy = 0}));
    EXPECT_FALSE(device->create_sampler({.min_lod = 2, .max_lod = 1}));
}

}  // namespace
}  // namespace lumo::rhi
