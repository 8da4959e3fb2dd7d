// Presenting while the driver runs out of memory, or loses the device: an error, and the next picture is shown.
#include <chrono>
#include <fmt/format.h>
#include <thread>

#include "backends/window.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/faults.hpp"
#include "tests/window/x_server.hpp"

namespace lumo::backends {
namespace {

using namespace testing_support;
using rhi::Api;
using testing::HasSubstr;

class WindowFaults : public testing::TestWithParam<Api> {
  protected:
    void SetUp() override {
        server_ = XServer::start();
        if (!server_) GTEST_SKIP() << "no X server: install xvfb";
        window_.emplace(must(Window::open(GetParam(), {.title = "faulty", .width = 64, .height = 48})));
        on_screen_ = server_->find("faulty");
        ASSERT_NE(on_screen_, 0u);
    }
    void TearDown() override {
        faults().disarm();
        window_.reset();
        server_.reset();
    }

    /// A device for the window; of what it says, `messages()` keeps the failures.
    rhi::Device open() {
        faults().start_counting();
        messages_.clear();
        return must(window_->create_device(
            {.validation = true, .disk_cache = false, .sink = [this](const rhi::Message& message) {
                 if (is_failure(message)) messages_.push_back(message);
             }}));
    }
    std::vector<rhi::Message>& messages() { return messages_; }

    Result<void> show(rhi::Device& device, std::array<float, 4> color) {
        window_->poll();
        auto picture = device.create_texture(
            {.name = "picture", .extent = {64, 48, 1}, .usage = rhi::TextureUsage::attachment});
        if (!picture) return tl::unexpected(picture.error());
        rhi::Commands commands = device.begin();
        (void)commands.raster_pass("clear", {.color = {{.view = picture->view(), .clear = color}}});
        commands.present(*picture);
        return device.wait(device.submit(std::move(commands)));
    }
    bool is_shown(uint32_t color) {
        using namespace std::chrono_literals;
        for (int i = 0; i < 400; ++i) {
            window_->poll();
            const auto shot = server_->screenshot(on_screen_);
            if (shot && shot->at(32, 24) == color && shot->at(1, 1) == color) return true;
            std::this_thread::sleep_for(5ms);
        }
        return false;
    }

  private:
    FaultyDriver driver_{GetParam()};
    std::unique_ptr<XServer> server_;
    std::optional<Window> window_;
    XWindow on_screen_ = 0;
    std::vector<rhi::Message> messages_;
};
INSTANTIATE_TEST_SUITE_P(Api, WindowFaults, both_apis, api_name);

TEST_P(WindowFaults, EachCallOfPresentingFailsOnceAndTheNextPictureIsShown) {
    int errors = 0;
    std::vector<std::string> failed;
    for (int call = 0;; ++call) {
        rhi::Device device = open();
        faults().arm(call);
        const Result<void> shown = show(device, {1, 0, 0, 1});
        const std::string function = faults().disarm();
        SCOPED_TRACE(fmt::format("call {}, {}", call, function));
        if (function.empty()) {
            must(shown);
            EXPECT_TRUE(messages().empty());
            break;
        }
        failed.push_back(function);
        if (!shown) {
            EXPECT_EQ(shown.error().kind, ErrorKind::out_of_memory) << to_string(shown.error());
            ++errors;
        }
        for (const rhi::Message& message : messages())
            EXPECT_TRUE(message.id == "device" || message.id == "present") << message.id << message.text;
        messages().clear();
        must(show(device, {0, 1, 0, 1}));
        EXPECT_TRUE(is_shown(0x00ff00));
        must(show(device, {0, 0, 1, 1}));
        EXPECT_TRUE(is_shown(0x0000ff));
        { const rhi::Device closed = std::move(device); }
        if (GetParam() == Api::vulkan) {
            EXPECT_THAT(faults().live(), testing::IsEmpty());
        }
        for (const rhi::Message& message : messages()) ADD_FAILURE() << message.id << ": " << message.text;
        if (HasFailure()) break;
    }
    EXPECT_GT(errors, 0);
    fmt::print("{}: {} calls failed, {} errors: {}\n", to_string(GetParam()), failed.size(), errors,
               fmt::join(failed, " "));
}

TEST_P(WindowFaults, ALossWhilePresentingIsSaidOnce) {
    int found_at = 0;
    for (int call = 0;; ++call) {
        rhi::Device device = open();
        must(show(device, {1, 1, 1, 1}));
        faults().arm_loss(call);
        (void)show(device, {1, 0, 0, 1});
        (void)show(device, {0, 1, 0, 1});
        if (!faults().is_lost()) break;
        ++found_at;
        SCOPED_TRACE(call);
        const auto shown = show(device, {0, 0, 1, 1});
        ASSERT_FALSE(shown);
        EXPECT_EQ(shown.error().kind, ErrorKind::device_lost);
        EXPECT_EQ(messages().size(), 1u);
        for (const rhi::Message& message : messages())
            EXPECT_THAT(message.text, HasSubstr(GetParam() == Api::gl ? "reset" : "lost"));
        messages().clear();
        { const rhi::Device closed = std::move(device); }
        for (const rhi::Message& message : messages()) ADD_FAILURE() << message.id << ": " << message.text;
        faults().disarm();
    }
    EXPECT_GE(found_at, 3);
}

}  // namespace
}  // namespace lumo::backends
