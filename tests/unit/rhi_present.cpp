// Presenting on a device without an API: what may be shown, and what the backend is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/rhi_fake_backend.hpp"

namespace lumo::rhi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

struct Presenting : testing::Test {
    fake::State state;
    std::vector<Check> checks;
    std::optional<Device> device;

    void SetUp() override {
        state.info.window = true;
        device.emplace(
            std::make_unique<fake::FakeBackend>(state),
            DeviceDesc{.sink = [this](const Message& message) { checks.push_back(message.check); }});
    }
    Texture picture(const TextureDesc& desc = {.name = "picture", .extent = {8, 4, 1}}) {
        return std::move(device->create_texture(desc).value());
    }
};

TEST_F(Presenting, IsAPassThatCopiesOutOfTheTexture) {
    Texture shown = picture({.extent = {8, 4, 1}, .usage = TextureUsage::attachment});
    Commands commands = device->begin();
    commands.raster_pass("draw", {.color = {{.view = shown.view()}}});
    commands.present(shown, false);
    device->submit(std::move(commands));
    ASSERT_THAT(state.passes, SizeIs(2));
    EXPECT_EQ(state.passes[1].name, "present");
    ASSERT_THAT(state.passes[1].commands, SizeIs(1));
    const auto& command = std::get<PresentCommand>(state.passes[1].commands[0]);
    EXPECT_EQ(command.texture, shown.handle());
    EXPECT_FALSE(command.vsync);
    ASSERT_THAT(state.passes[1].step_barriers[0], SizeIs(1));
    const Barrier& barrier = state.passes[1].step_barriers[0][0];
    EXPECT_EQ(barrier.before, Access::color_attachment);
    EXPECT_EQ(barrier.after, Access::copy_read);
    EXPECT_EQ(barrier.after_layout, Layout::copy_source);
    EXPECT_THAT(checks, IsEmpty());
}

TEST_F(Presenting, NeedsAWindow) {
    state.info.window = false;
    Texture shown = picture();
    device->begin().present(shown);
    EXPECT_THAT(checks, ElementsAre(Check::not_presentable));
}

TEST_F(Presenting, HappensOnceASubmission) {
    Texture shown = picture();
    for (int submission = 0; submission < 2; ++submission) {
        Commands commands = device->begin();
        commands.present(shown);
        EXPECT_THAT(checks, SizeIs(size_t(submission)));
        commands.present(shown);
        EXPECT_THAT(checks, SizeIs(size_t(submission + 1)));
    }
    EXPECT_THAT(checks, testing::Each(Check::not_presentable));
}

TEST_F(Presenting, TakesColourOfTwoDimensionsAlone) {
    const TextureDesc refused[] = {
        {.dimension = Dimension::d3, .extent = {4, 4, 4}},
        {.dimension = Dimension::d2_array, .extent = {4, 4, 1}, .layers = 2},
        {.dimension = Dimension::d2_multisample,
         .extent = {4, 4, 1},
         .samples = 4,
         .usage = TextureUsage::attachment},
        {.format = Format::rgba8_uint, .extent = {4, 4, 1}},
        {.format = Format::d32_float, .extent = {4, 4, 1}, .usage = TextureUsage::attachment},
    };
    for (const TextureDesc& desc : refused) {
        Texture shown = picture(desc);
        device->begin().present(shown);
        EXPECT_THAT(checks, ElementsAre(Check::not_presentable)) << format_info(desc.format).name;
        checks.clear();
    }
    for (Format format : {Format::rgba8_unorm, Format::rgba8_srgb, Format::rgba16_float}) {
        Texture shown = picture({.format = format, .extent = {4, 4, 1}});
        device->begin().present(shown);
        EXPECT_THAT(checks, IsEmpty()) << format_info(format).name;
    }
}

TEST_F(Presenting, OfATextureThatIsGoneIsDropped) {
    device->begin().present(Texture{});
    EXPECT_THAT(checks, ElementsAre(Check::stale_handle));
}

TEST_F(Presenting, WaitsForNoOpenPass) {
    Texture shown = picture();
    Commands commands = device->begin();
    Pass open = commands.pass("open");
    commands.present(shown);
    EXPECT_THAT(checks, ElementsAre(Check::pass_open));
}

}  // namespace
}  // namespace lumo::rhi
