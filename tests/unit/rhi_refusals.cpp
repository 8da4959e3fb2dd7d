// What the environment refuses to a submission, on a device without an API: who is told, and what stays true.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/rhi_fake_backend.hpp"
#include "tests/unit/rhi_fake_programs.hpp"

namespace lumo::rhi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

struct Refusals : testing::Test {
    const Error no_memory{ErrorKind::out_of_memory, "driver", "no memory", ""};
    fake::State state;
    std::vector<Message> messages;
    std::optional<Device> device;

    Refusals() {
        device.emplace(std::make_unique<fake::FakeBackend>(state),
                       DeviceDesc{.sink = [this](const Message& message) { messages.push_back(message); }});
    }
    Buffer buffer() { return std::move(device->create_buffer({.name = "mine", .size = 256}).value()); }
    Texture picture() {
        return std::move(device->create_texture({.name = "picture", .extent = {4, 4, 1}}).value());
    }
    Submission clear(const Texture& texture) {
        Commands commands = device->begin();
        commands.pass("clear").clear(texture.view());
        return device->submit(std::move(commands));
    }
    void expect_out_of_memory(const Result<void>& result) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().kind, ErrorKind::out_of_memory);
        EXPECT_THAT(to_string(result.error()), HasSubstr("no memory"));
    }
};

TEST_F(Refusals, WhoeverWaitsForTheSubmissionIsToldAndTheNextOneIsFine) {
    Texture texture = picture();
    for (const char* call : {"begin", "emit", "submit"}) {
        SCOPED_TRACE(call);
        state.failing = {{call, no_memory}};
        messages.clear();
        const Submission refused = clear(texture);
        expect_out_of_memory(device->wait(refused));
        expect_out_of_memory(device->wait(refused));
        ASSERT_THAT(messages, SizeIs(1));
        EXPECT_EQ(messages[0].check, Check::none);
        const Submission fine = clear(texture);
        EXPECT_TRUE(device->wait(fine));
        expect_out_of_memory(device->wait(refused));
        EXPECT_THAT(messages, SizeIs(1));
    }
}

TEST_F(Refusals, WhatDidNotRunIsNotTakenForDone) {
    for (const char* call : {"begin", "submit"}) {
        SCOPED_TRACE(call);
        Texture texture = picture();
        (void)clear(texture);
        state.failing = {{call, no_memory}};
        {
            Commands commands = device->begin();
            (void)commands.pass("read").read(texture, whole_mip(texture.desc()));
        }
        {
            Commands commands = device->begin();
            (void)commands.pass("read").read(texture, whole_mip(texture.desc()));
        }
        // As if the refused submission had not been: the texture is still as the clear left it.
        const auto& barriers = state.passes.back().step_barriers[0];
        ASSERT_THAT(barriers, SizeIs(1));
        EXPECT_EQ(barriers[0].before, Access::copy_write);
        EXPECT_EQ(barriers[0].before_layout, Layout::copy_destination);
        EXPECT_EQ(barriers[0].after_layout, Layout::copy_source);
    }
}

TEST_F(Refusals, BarriersOfAPassThatLacksCommandsStand) {
    Texture texture = picture();
    (void)clear(texture);
    state.failing = {{"emit", no_memory}};
    for (int i = 0; i < 2; ++i) {
        Commands commands = device->begin();
        (void)commands.pass("read").read(texture, whole_mip(texture.desc()));
    }
    EXPECT_THAT(state.passes.back().step_barriers[0], IsEmpty()) << "the pass before has moved it";
}

TEST_F(Refusals, BytesOfARefusedSubmissionAreAnErrorAndTheirMemoryIsGivenBack) {
    Buffer mine = buffer();
    const auto held = [&] { return device->memory().size(); };
    const size_t before = held();
    for (const char* call : {"begin", "emit", "submit"}) {
        SCOPED_TRACE(call);
        state.failing = {{call, no_memory}};
        Commands commands = device->begin();
        const Readback read = commands.pass("read").read(mine.slice());
        device->submit(std::move(commands));
        EXPECT_EQ(held(), before) << "even if nobody takes them";
        // However late: a submission is forgotten after a while, its bytes are not.
        for (int i = 0; i < 40; ++i) device->submit(device->begin());
        const auto bytes = device->take(read);
        ASSERT_FALSE(bytes);
        EXPECT_EQ(bytes.error().kind, ErrorKind::out_of_memory);
        EXPECT_EQ(device->take(read).error().kind, ErrorKind::invalid_argument) << "once";
        messages.clear();
    }
}

TEST_F(Refusals, ACommandThatFindsNoStagingMemoryFailsItsSubmission) {
    Buffer mine = buffer();
    state.failing = {{"create_buffer", no_memory}};
    Commands commands = device->begin();
    commands.pass("upload").upload(mine.slice(), std::vector<std::byte>(256));
    const Submission submission = device->submit(std::move(commands));
    expect_out_of_memory(device->wait(submission));
    EXPECT_THAT(device->wait(submission).error().message, HasSubstr("bytes of upload memory"));
    EXPECT_THAT(messages, SizeIs(1));
}

TEST_F(Refusals, ErrorsSayWhatWasAskedFor) {
    state.failing = {{"create_buffer", no_memory}, {"create_texture", no_memory}};
    EXPECT_THAT(to_string(device->create_buffer({.name = "lights", .size = 12345}).error()),
                HasSubstr("12345 bytes of device memory"));
    EXPECT_THAT(to_string(device->create_texture({.extent = {7, 9, 1}}).error()), HasSubstr("7x9x1"));
}

TEST_F(Refusals, AWaitThatIsRefusedCanBeTriedAgain) {
    Texture texture = picture();
    const Submission submission = clear(texture);
    state.failing = {{"wait", no_memory}};
    expect_out_of_memory(device->wait(submission));
    EXPECT_TRUE(device->wait(submission));
}

TEST_F(Refusals, ALossIsSaidOnceWhereverItIsFound) {
    for (const char* call : {"begin", "emit", "submit", "wait", "create_buffer", "create_texture"}) {
        SCOPED_TRACE(call);
        messages.clear();
        device.emplace(std::make_unique<fake::FakeBackend>(state),
                       DeviceDesc{.sink = [this](const Message& message) { messages.push_back(message); }});
        Texture texture = picture();
        state.failing = {{call, {ErrorKind::device_lost, "driver", "lost", ""}}};
        (void)device->wait(clear(texture));
        (void)device->create_buffer({.name = "another", .size = 4});
        (void)device->create_texture({.name = "another"});
        ASSERT_TRUE(state.failing.empty());
        EXPECT_EQ(device->create_sampler({}).error().kind, ErrorKind::device_lost);
        EXPECT_EQ(device->create_compute_pipeline<fake::Store>().error().kind, ErrorKind::device_lost);
        const Submission after = clear(texture);
        EXPECT_TRUE(device->finished(after));
        EXPECT_EQ(device->wait(after).error().kind, ErrorKind::device_lost);
        EXPECT_EQ(device->take({}).error().kind, ErrorKind::device_lost);
        EXPECT_THAT(messages, SizeIs(1));
        texture = {};
        device.reset();
        EXPECT_EQ(state.alive(), 0u);
        EXPECT_THAT(messages, SizeIs(1));
    }
}

}  // namespace
}  // namespace lumo::rhi
