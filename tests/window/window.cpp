// Windows as someone in front of the screen sees them: what Commands::present shows, and where.
#include "backends/window.hpp"

#include <chrono>
#include <functional>
#include <thread>

#include "tests/support/device_test.hpp"
#include "tests/window/x_server.hpp"

namespace lumo::backends {
namespace {

using namespace testing_support;
using rhi::Api;
using rhi::Extent;
using rhi::Format;

constexpr uint32_t window_width = 320, window_height = 200;

/// Texels that tell each from its neighbours and each corner from the others: red grows to the right, green
/// upwards, blue is the texel's own. `kind` changes all of them.
std::vector<uint8_t> pattern(Extent size, uint8_t kind) {
    std::vector<uint8_t> texels;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x)
            for (uint32_t value : {255 * x / (size.width - 1), 255 * y / (size.height - 1),
                                   (x * 7 + y * 13 + kind * 101) % 256, 255u})
                texels.push_back(uint8_t(value));
    return texels;
}

/// Texels of 8 bits as someone sees them: the last row on top.
Picture seen(Extent size, const std::vector<std::byte>& texels) {
    Picture picture{size.width, size.height};
    for (uint32_t y = size.height; y-- > 0;)
        for (uint32_t x = 0; x < size.width; ++x) {
            const std::byte* texel = &texels[(size_t(y) * size.width + x) * 4];
            picture.pixels.push_back(uint32_t(texel[0]) << 16 | uint32_t(texel[1]) << 8 | uint32_t(texel[2]));
        }
    return picture;
}

struct Difference {
    size_t pixels = 0;
    uint32_t x = 0, y = 0;  ///< of the first
    uint32_t seen = 0, expected = 0;
};

std::optional<Difference> compare(const Picture& seen, const Picture& expected) {
    Difference difference;
    for (uint32_t i = expected.width * expected.height; i-- > 0;) {
        if (seen.pixels[i] == expected.pixels[i]) continue;
        difference = {difference.pixels + 1, i % expected.width, i / expected.width, seen.pixels[i],
                      expected.pixels[i]};
    }
    return difference.pixels ? std::optional(difference) : std::nullopt;
}

class WindowTest : public testing::TestWithParam<Api> {
  protected:
    void SetUp() override {
        server_ = XServer::start();
        if (!server_) GTEST_SKIP() << "no X server: install xvfb";
        window_.emplace(must(Window::open(
            GetParam(), {.title = "under test", .width = window_width, .height = window_height})));
        auto made = window_->create_device({.validation = true, .sink = [this](const rhi::Message& message) {
                                                messages_.push_back(message);
                                            }});
        ASSERT_TRUE(made) << to_string(made.error());
        device_.emplace(std::move(*made));
        on_screen_ = server_->find("under test");
        ASSERT_NE(on_screen_, 0u);
    }
    void TearDown() override {
        picture_ = {};
        device_.reset();
        window_.reset();
        server_.reset();
        for (const rhi::Message& message : messages_)
            if (is_failure(message)) ADD_FAILURE() << message.id << ": " << message.text;
    }

    rhi::Device& device() { return *device_; }
    Window& window() { return *window_; }
    XServer& server() { return *server_; }
    XWindow on_screen() const { return on_screen_; }

    const rhi::Texture& picture() const { return picture_; }
    /// A new picture, of the window's size unless told otherwise.
    const rhi::Texture& draw(Format format = Format::rgba8_unorm, std::optional<Extent> size = {}) {
        const Extent extent = size.value_or(window().size());
        picture_ = must(device().create_texture(
            {.name = "picture", .format = format, .extent = extent, .usage = rhi::TextureUsage::attachment}));
        must(device().upload(picture_, whole_mip(picture_.desc()), bytes_of(pattern(extent, ++drawn_))));
        return picture_;
    }
    void present(bool vsync = true) {
        window().poll();
        rhi::Commands commands = device().begin();
        // As every frame does, it draws somewhere else first.
        commands.raster_pass("draw", {.color = {{.view = picture_.view(), .load = rhi::Load::keep}}});
        commands.present(picture_, vsync);
        must(device().wait(device().submit(std::move(commands))));
    }
    /// Polls the window until something is so.
    bool becomes(const std::function<bool()>& so) {
        using namespace std::chrono_literals;
        const auto end = std::chrono::steady_clock::now() + 10s;
        while (!so()) {
            if (std::chrono::steady_clock::now() > end) return false;
            window().poll();
            std::this_thread::sleep_for(5ms);
        }
        return true;
    }
    /// The window shows what is read back from the picture.
    void expect_shown() {
        const Picture expected =
            seen(picture_.desc().extent, must(device().download(picture_, whole_mip(picture_.desc()))));
        std::optional<Picture> shot;
        if (becomes([&] { return (shot = server().screenshot(on_screen())) && *shot == expected; })) return;
        ASSERT_TRUE(shot) << "the window is not on the screen";
        ASSERT_EQ(shot->width, expected.width);
        ASSERT_EQ(shot->height, expected.height);
        const auto difference = compare(*shot, expected);
        ADD_FAILURE() << difference->pixels << " pixels differ, the first at " << difference->x << ","
                      << difference->y << " from the top left: " << std::hex << difference->seen
                      << " instead of " << difference->expected;
    }

  private:
    std::unique_ptr<XServer> server_;
    std::vector<rhi::Message> messages_;
    std::optional<Window> window_;
    std::optional<rhi::Device> device_;
    rhi::Texture picture_;
    XWindow on_screen_ = 0;
    uint8_t drawn_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Api, WindowTest, both_apis, api_name);

TEST_P(WindowTest, ShowsATextureWithRowZeroAtTheBottom) {
    EXPECT_EQ(window().size(), (Extent{window_width, window_height, 1}));
    EXPECT_TRUE(device().info().window);
    draw();
    present();
    expect_shown();
    // And once more by eye: red grows to the right, green upwards.
    const Picture shot = *server().screenshot(on_screen());
    EXPECT_EQ(shot.at(0, 0) >> 8, 0x00ffu);
    EXPECT_EQ(shot.at(window_width - 1, 0) >> 8, 0xffffu);
    EXPECT_EQ(shot.at(0, window_height - 1) >> 8, 0x0000u);
    EXPECT_EQ(shot.at(window_width - 1, window_height - 1) >> 8, 0xff00u);
}

TEST_P(WindowTest, ShowsTexelsAsTheyAreStored) {
    for (Format format : {Format::rgba8_srgb, Format::rgba8_unorm, Format::rgba8_srgb}) {
        draw(format);
        present();
        expect_shown();
    }
}

TEST_P(WindowTest, ShowsFloatsBetweenZeroAndOne) {
    rhi::Texture bright = must(device().create_texture({.name = "bright",
                                                        .format = Format::rgba16_float,
                                                        .extent = window().size(),
                                                        .usage = rhi::TextureUsage::attachment}));
    rhi::Commands commands = device().begin();
    commands.pass("clear").clear(bright.view(), std::array{-1.0f, 1.0f, 7.0f, 1.0f});
    commands.present(bright);
    device().submit(std::move(commands));
    const Picture expected{window_width, window_height,
                           std::vector<uint32_t>(size_t(window_width) * window_height, 0x00ffff)};
    EXPECT_TRUE(becomes([&] { return server().screenshot(on_screen()) == expected; }));
}

TEST_P(WindowTest, ShowsEachFrameAfterTheOther) {
    for (int frame = 0; frame < 12; ++frame) {
        draw();
        present();
        if (frame % 3 == 0) expect_shown();
    }
    expect_shown();
}

TEST_P(WindowTest, StretchesAPictureOfAnotherSize) {
    draw(Format::rgba8_unorm, Extent{window_width / 2, window_height * 2, 1});
    present();
    // Linear ramps stay the same ramps, to within a texel on either side.
    const auto close = [&](const Picture& shot) {
        for (uint32_t y = 0; y < window_height; ++y)
            for (uint32_t x = 0; x < window_width; ++x) {
                const int red = int(shot.at(x, y) >> 16), green = int(shot.at(x, y) >> 8 & 0xff);
                if (std::abs(red - int(255 * x / (window_width - 1))) > 3) return false;
                if (std::abs(green - int(255 - 255 * y / (window_height - 1))) > 3) return false;
            }
        return true;
    };
    EXPECT_TRUE(becomes([&] {
        const auto shot = server().screenshot(on_screen());
        return shot && close(*shot);
    }));
}

TEST_P(WindowTest, FollowsItsSize) {
    draw();
    present();
    for (const Extent& size : {Extent{400, 300}, Extent{100, 120}, Extent{701, 33}, Extent{320, 500}}) {
        window().resize(size.width, size.height);
        ASSERT_TRUE(becomes([&] { return window().size() == size; }));
        draw();
        present();
        present();
        expect_shown();
    }
}

TEST_P(WindowTest, OutlivesBeingResizedWhileItIsDrawnTo) {
    draw();
    for (uint32_t i = 0; i < 40; ++i) {
        const Extent size{200 + i * 37 % 300, 150 + i * 53 % 200, 1};
        server().resize(on_screen(), size.width, size.height);
        for (int frame = 0; frame < 3; ++frame) present();  // of whatever size the picture has
    }
    server().resize(on_screen(), 250, 260);
    ASSERT_TRUE(becomes([&] { return window().size() == Extent{250, 260, 1}; }));
    draw();
    present();
    present();
    expect_shown();
}

TEST_P(WindowTest, ShowsNothingWhileMinimised) {
    draw();
    present();
    expect_shown();
    for (int round = 0; round < 2; ++round) {
        server().minimise(on_screen());
        ASSERT_TRUE(becomes([&] { return window().size() == Extent{0, 0, 1}; }));
        for (int frame = 0; frame < 8; ++frame) present();
        server().restore(on_screen());
        ASSERT_TRUE(becomes([&] { return window().size() == Extent{window_width, window_height, 1}; }));
        draw();
        present();
        present();
        expect_shown();
    }
}

TEST_P(WindowTest, WaitsForTheScreenOrNot) {
    for (bool vsync : {false, true, false, true}) {
        for (int frame = 0; frame < 5; ++frame) {
            draw();
            present(vsync);
        }
        expect_shown();
    }
}

TEST_P(WindowTest, KeepsSeveralFramesInFlight) {
    draw();
    std::optional<rhi::Submission> last;
    for (int frame = 0; frame < 30; ++frame) {
        window().poll();
        rhi::Commands commands = device().begin();
        commands.present(picture(), frame % 2 == 0);
        last = device().submit(std::move(commands));
    }
    must(device().wait(*last));
    expect_shown();
}

TEST_P(WindowTest, AsksToBeClosed) {
    EXPECT_FALSE(window().should_close());
    server().close(on_screen());
    EXPECT_TRUE(becomes([&] { return window().should_close(); }));
}

struct WindowsTest : testing::Test {
    std::unique_ptr<XServer> server = XServer::start();
    void SetUp() override {
        if (!server) GTEST_SKIP() << "no X server: install xvfb";
    }
};

/// A frame in a window of its own.
void show_one(Api api) {
    Window window = must(Window::open(api, {.title = "one"}));
    rhi::Device device = must(window.create_device());
    rhi::Texture picture = must(device.create_texture({.extent = window.size()}));
    device.begin().present(picture);
}

TEST_F(WindowsTest, OpenAgainAfterTheLastWasClosed) {
    for (Api api : {Api::gl, Api::vulkan, Api::gl, Api::vulkan}) show_one(api);
}

TEST_F(WindowsTest, OfBothApisLiveBesideEachOther) {
    Window first = must(Window::open(Api::gl, {.title = "gl"}));
    Window second = must(Window::open(Api::vulkan, {.title = "vulkan", .width = 300, .height = 200}));
    rhi::Device one = must(first.create_device());
    rhi::Device other = must(second.create_device());
    for (int frame = 0; frame < 3; ++frame)
        for (auto [window, device] : {std::pair(&first, &one), std::pair(&second, &other)}) {
            rhi::Texture picture = must(device->create_texture({.extent = window->size()}));
            rhi::Commands commands = device->begin();
            commands.present(picture);
            EXPECT_TRUE(device->wait(device->submit(std::move(commands))));
        }
}

TEST_F(WindowsTest, StayOpenForTheirDevice) {
    for (Api api : {Api::gl, Api::vulkan}) {
        auto window = std::make_optional(must(Window::open(api, {.title = "kept"})));
        rhi::Device device = must(window->create_device());
        rhi::Texture picture = must(device.create_texture({.extent = window->size()}));
        window.reset();
        rhi::Commands commands = device.begin();
        commands.present(picture);
        EXPECT_TRUE(device.wait(device.submit(std::move(commands))));
        EXPECT_NE(server->find("kept"), 0u);
    }
}

TEST_F(WindowsTest, AreNotOfANamedDeviceThatAnotherWouldAnswerFor) {
    for (Api api : {Api::gl, Api::vulkan}) {
        Window window = must(Window::open(api, {.title = "named"}));
        auto device = window.create_device({.name = "no such device"});
        ASSERT_FALSE(device);
        EXPECT_EQ(device.error().kind, ErrorKind::no_device);
        EXPECT_TRUE(window.create_device()) << "the window is still good";
    }
}

TEST(Windows, WithoutADisplayAreAnError) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    for (Api api : {Api::gl, Api::vulkan}) {
        auto window = Window::open(api);
        ASSERT_FALSE(window);
        EXPECT_EQ(window.error().kind, ErrorKind::no_device);
        EXPECT_THAT(window.error().message, testing::HasSubstr("DISPLAY"));
    }
}

}  // namespace
}  // namespace lumo::backends
