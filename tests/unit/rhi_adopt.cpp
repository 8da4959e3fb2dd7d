// What is a host's: its textures come from its hands in front of their first use in a submission and go back behind
// the last, its semaphores go to the backend, and nothing of the host's is counted as lumo's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/rhi_fake_backend.hpp"
#include "tests/unit/rhi_fake_programs.hpp"

namespace lumo::rhi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

struct Adopt : testing::Test {
    fake::State state;
    std::vector<Message> messages;
    std::optional<Device> device;

    Adopt() {
        device.emplace(std::make_unique<fake::FakeBackend>(state),
                       DeviceDesc{.sink = [this](const Message& message) { messages.push_back(message); }});
    }

    Texture host_texture(uint32_t mips = 1) {
        return std::move(device
                             ->adopt_texture({.name = "host's", .extent = {8, 8}, .mips = mips},
                                             {.object = 7, .layout_before = 2, .layout_after = 5})
                             .value());
    }
    /// A submission that copies one mip of the host's texture into a buffer.
    Submission read(const Texture& texture, uint32_t mip = 0) {
        Commands commands = device->begin();
        commands.pass("read").read(texture, whole_mip(texture.desc(), mip));
        return device->submit(std::move(commands));
    }
};

TEST_F(Adopt, ATextureComesFromTheHostAndGoesBackWithEverySubmission) {
    const Texture picture = host_texture();
    for (int submission = 0; submission < 2; ++submission) {
        read(picture);
        const std::vector<Barrier>& taken = state.passes.back().step_barriers.at(0);
        ASSERT_THAT(taken, SizeIs(1)) << submission;
        EXPECT_EQ(taken[0].before, Access::external);
        EXPECT_EQ(taken[0].before_layout, Layout::external);
        EXPECT_EQ(taken[0].after_layout, Layout::copy_source);
        ASSERT_THAT(state.handed_back, SizeIs(1)) << submission;
        EXPECT_EQ(state.handed_back[0].memory, taken[0].memory);
        EXPECT_EQ(state.handed_back[0].before, Access::copy_read | Access::external);
        EXPECT_EQ(state.handed_back[0].before_layout, Layout::copy_source);
        EXPECT_EQ(state.handed_back[0].after, Access::external);
        EXPECT_EQ(state.handed_back[0].after_layout, Layout::external);
    }
}

TEST_F(Adopt, ATextureGoesBackWholeAndOnlyWhereItWasUsed) {
    const Texture used = host_texture(3), unused = host_texture();
    read(used, 1);
    ASSERT_THAT(state.handed_back, SizeIs(3)) << "a mip that was not used changes its layout as well";
    for (uint32_t mip = 0; mip < 3; ++mip) {
        const Barrier& barrier = state.handed_back[mip];
        EXPECT_EQ(barrier.memory, (MemoryId{MemoryId::Kind::texture, used.handle().index, mip}));
        EXPECT_EQ(barrier.before_layout, mip == 1 ? Layout::copy_source : Layout::external);
        EXPECT_EQ(barrier.after_layout, Layout::external);
    }
    device->submit(device->begin());
    EXPECT_THAT(state.handed_back, IsEmpty());
}

TEST_F(Adopt, ABufferComesAndGoesWithoutALayout) {
    const Buffer values =
        std::move(device->adopt_buffer({.name = "values", .size = 64}, {.object = 9}).value());
    for (int submission = 0; submission < 2; ++submission) {
        Commands commands = device->begin();
        {
            Pass pass = commands.pass("read twice");
            pass.read(values.slice());
            pass.read(values.slice());
        }
        device->submit(std::move(commands));
        const auto& taken = state.passes.back().step_barriers;
        ASSERT_THAT(taken.at(0), SizeIs(1)) << submission;
        EXPECT_EQ(taken[0][0].before, Access::external);
        EXPECT_EQ(taken[0][0].before_layout, taken[0][0].after_layout);
        EXPECT_THAT(taken.at(1), IsEmpty()) << "it has come already";
        ASSERT_THAT(state.handed_back, SizeIs(1)) << submission;
        EXPECT_EQ(state.handed_back[0].memory, (MemoryId{MemoryId::Kind::buffer, values.handle().index}));
        EXPECT_EQ(state.handed_back[0].after, Access::external);
        EXPECT_EQ(state.handed_back[0].before_layout, state.handed_back[0].after_layout);
    }
    EXPECT_EQ(values.mapped(), nullptr);
    EXPECT_FALSE(
        device->adopt_buffer({.name = "mapped", .size = 4, .memory = Memory::upload}, {.object = 9}));
    EXPECT_FALSE(device->adopt_buffer({.name = "nothing", .size = 4}, {.object = 0}));
    EXPECT_FALSE(device->adopt_buffer({.name = "empty", .size = 0}, {.object = 9}));
}

TEST(AdoptPlan, EveryBarrierOfAHostsTextureIsNeeded) {
    const MemoryId host{MemoryId::Kind::texture, 0, 0}, own{MemoryId::Kind::texture, 1, 0};
    const Use external{.memory = host, .access = Access::external, .layout = Layout::external};
    const Use sampled{.memory = host,
                      .access = Access::sampled_read,
                      .stages = Stages::compute,
                      .layout = Layout::read_only};
    const Use drawn{.memory = host, .access = Access::color_attachment, .layout = Layout::color_attachment};
    const Use other{
        .memory = own, .access = Access::storage_write, .stages = Stages::compute, .layout = Layout::general};
    const std::vector<Scope> scopes{{"host", {external}}, {"sample", {sampled, other}}, {"host", {external}},
                                    {"draw", {drawn}},    {"sample again", {sampled}},  {"host", {external}}};
    const auto plan = plan_barriers(scopes);
    EXPECT_THAT(find_hazards(scopes, plan), IsEmpty());
    size_t removed = 0;
    for (size_t scope = 0; scope < plan.size(); ++scope) {
        auto less = plan;
        std::erase_if(less[scope], [&](const Barrier& barrier) { return barrier.memory == host; });
        removed += plan[scope].size() - less[scope].size();
        EXPECT_FALSE(find_hazards(scopes, less).empty()) << scope;
    }
    EXPECT_EQ(removed, scopes.size());
}

TEST_F(Adopt, ATextureOfLumosOwnNeverGoesBack) {
    const Texture own = std::move(device->create_texture({.name = "own", .extent = {8, 8}}).value());
    read(own);
    EXPECT_THAT(state.handed_back, IsEmpty());
    EXPECT_EQ(state.passes.back().step_barriers.at(0).at(0).before_layout, Layout::undefined);
}

TEST_F(Adopt, TheTraceTellsOfBothSides) {
    device->set_tracing(true);
    const Texture picture = host_texture();
    EXPECT_EQ(device->trace(read(picture)),
              "read/read: \"host's\" copy_read\n"
              "    \"host's\": external -> copy_read, external -> copy_source\n"
              "hand back: \"host's\" external\n"
              "    \"host's\": copy_read|external -> external, copy_source -> external\n");
}

TEST_F(Adopt, AnIndexThatWasTheHostsIsNotAfterwards) {
    { Texture picture = host_texture(); }
    const Texture own = std::move(device->create_texture({.name = "own", .extent = {8, 8}}).value());
    read(own);
    EXPECT_THAT(state.handed_back, IsEmpty());
    EXPECT_EQ(state.passes.back().step_barriers.at(0).at(0).before_layout, Layout::undefined);
}

TEST_F(Adopt, WhatIsReleasedWhileItIsUsedGoesBackStill) {
    state.finish_at_once = false;
    Commands commands = device->begin();
    {
        const Texture picture = host_texture();
        commands.pass("read").read(picture, whole_mip(picture.desc()));
    }
    device->submit(std::move(commands));
    EXPECT_THAT(state.handed_back, SizeIs(1));
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Adopt, ATextureTakesNoMemoryOfLumos) {
    const Texture picture = host_texture();
    const auto memory = device->memory();
    const auto entry = std::ranges::find(memory, "host's", &MemoryEntry::name);
    ASSERT_NE(entry, memory.end());
    EXPECT_EQ(entry->bytes, 0u);
}

TEST_F(Adopt, WhatCannotBeATextureIsRefused) {
    const auto nothing = device->adopt_texture({.name = "nothing"}, {.object = 0});
    ASSERT_FALSE(nothing);
    EXPECT_EQ(nothing.error().kind, ErrorKind::invalid_argument);
    EXPECT_EQ(nothing.error().subject, "nothing");
    EXPECT_FALSE(device->adopt_texture({.name = "flat", .extent = {0, 8}}, {.object = 7}));
    state.failing["adopt_texture"] = {ErrorKind::unsupported, "here", "not a host's", ""};
    const auto refused = device->adopt_texture({.name = "refused"}, {.object = 7});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("not a host's"));
    EXPECT_EQ(state.alive(), 0u);
}

TEST_F(Adopt, SemaphoresReachTheBackend) {
    Commands commands = device->begin();
    commands.wait({.object = 11, .value = 3});
    commands.wait({.object = 12});
    commands.signal({.object = 13});
    commands.pass("work");
    commands.signal({.object = 14, .value = 9});
    device->submit(std::move(commands));
    EXPECT_THAT(state.waits, ElementsAre(11, 12));
    EXPECT_THAT(state.signals, ElementsAre(13, 14));
    EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Adopt, AWaitBehindWorkIsRefused) {
    Commands commands = device->begin();
    commands.pass("work");
    commands.wait({.object = 11});
    device->submit(std::move(commands));
    EXPECT_THAT(state.waits, IsEmpty());
    ASSERT_THAT(messages, SizeIs(1));
    EXPECT_EQ(messages[0].check, Check::sync_order);
}

TEST_F(Adopt, WhatTheBackendRefusesIsSaid) {
    state.failing["signal"] = {ErrorKind::unsupported, "device", "no semaphores here", ""};
    Commands commands = device->begin();
    commands.signal({.object = 13});
    ASSERT_THAT(messages, SizeIs(1));
    EXPECT_THAT(messages[0].text, HasSubstr("no semaphores here"));
}

}  // namespace
}  // namespace lumo::rhi
