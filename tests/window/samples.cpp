// The small samples as their users run them.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "scene/image.hpp"
#include "tests/window/x_server.hpp"

namespace lumo::testing_support {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A running program, ended with its owner.
class Process {
  public:
    explicit Process(std::vector<std::string> arguments) : process_(fork()) {
        if (process_ != 0) return;
        std::vector<char*> pointers;
        pointers.reserve(arguments.size() + 1);
        for (std::string& argument : arguments) pointers.push_back(argument.data());
        pointers.push_back(nullptr);
        execv(pointers[0], pointers.data());
        _exit(127);
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    ~Process() {
        if (process_ == 0) return;
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    /// Its exit code, or -1 where it runs on for 20 seconds or crashes.
    int exit_code() {
        int status = 0;
        for (int i = 0; i < 2000; ++i) {
            if (waitpid(process_, &status, WNOHANG) == process_) {
                process_ = 0;
                return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            }
            std::this_thread::sleep_for(10ms);
        }
        return -1;
    }

  private:
    pid_t process_;
};

struct SampleTest : testing::TestWithParam<std::string> {
    std::filesystem::path file(const std::string& name) const {
        return std::filesystem::path(testing::TempDir()) /
               (std::to_string(getpid()) + "." + GetParam() + name);
    }
};
INSTANTIATE_TEST_SUITE_P(Api, SampleTest, testing::Values("gl", "vulkan"),
                         [](const auto& info) { return info.param; });

Picture picture_of(const scene::Image8& image) {
    Picture picture{image.width, image.height};
    for (size_t i = 0; i < image.values.size(); i += 4)
        picture.pixels.push_back(uint32_t(image.values[i]) << 16 | uint32_t(image.values[i + 1]) << 8 |
                                 image.values[i + 2]);
    return picture;
}

/// Whether the triangle is there, in the middle and the right way up: red and green below, blue on top.
bool shows_triangle(const Picture& shot) {
    const double side = std::min(shot.width, shot.height);
    const auto near_corner = [&](double x, double y) {
        // A tenth of the way to the triangle's centre, which is at (0, -0.25); y is up.
        x *= 0.9;
        y = y * 0.9 - 0.025;
        const uint32_t pixel =
            shot.at(uint32_t(0.5 * (shot.width + x * side)), uint32_t(0.5 * (shot.height - y * side)));
        return std::array{pixel >> 16, pixel >> 8 & 0xff, pixel & 0xff};
    };
    const auto red = near_corner(-0.87, -0.75), green = near_corner(0.87, -0.75), blue = near_corner(0, 0.75);
    return red[0] > 200 && red[1] < 120 && red[2] < 120 && green[1] > 200 && green[0] < 120 &&
           green[2] < 120 && blue[2] > 200 && blue[0] < 120 && blue[1] < 120;
}

TEST_P(SampleTest, TriangleDrawsFollowsItsWindowAndSavesWhatItShows) {
    const auto server = XServer::start();
    if (!server) GTEST_SKIP() << "no X server: install xvfb";
    const auto screenshot = file(".triangle.png");
    Process triangle({LUMO_TRIANGLE, "--api", GetParam(), "--no-vsync", "--screenshot", screenshot.string()});
    const XWindow window = server->find("lumo: triangle");
    ASSERT_NE(window, 0u);

    std::optional<Picture> shot;
    const auto shows = [&](uint32_t width, uint32_t height) {
        for (int i = 0; i < 500; ++i) {
            shot = server->screenshot(window);
            if (shot && shot->width == width && shot->height == height && shows_triangle(*shot)) return true;
            std::this_thread::sleep_for(20ms);
        }
        return false;
    };
    server->resize(window, 400, 300);
    EXPECT_TRUE(shows(400, 300));
    server->minimise(window);
    std::this_thread::sleep_for(200ms);
    server->restore(window);
    server->resize(window, 300, 500);
    EXPECT_TRUE(shows(300, 500));

    server->close(window);
    EXPECT_EQ(triangle.exit_code(), 0);
    const auto saved = scene::read_image8(screenshot);
    std::filesystem::remove(screenshot);
    ASSERT_TRUE(saved) << to_string(saved.error());
    ASSERT_TRUE(shot);
    EXPECT_TRUE(picture_of(*saved) == *shot) << "the file differs from the screen";
}

TEST_P(SampleTest, TriangleEndsAfterItsFrames) {
    const auto server = XServer::start();
    if (!server) GTEST_SKIP() << "no X server: install xvfb";
    EXPECT_EQ(Process({LUMO_TRIANGLE, "--api", GetParam(), "--frames", "3"}).exit_code(), 0);
}

TEST_P(SampleTest, TriangleNeedsADisplay) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    EXPECT_EQ(Process({LUMO_TRIANGLE, "--api", GetParam(), "--frames", "1"}).exit_code(), 1);
}

/// The host's context is GLX's or EGL's; the screen shows what it draws with lumo's light.
TEST(EmbedGlTest, DrawsInAWindowOfGlxAndOfEgl) {
    const auto server = XServer::start();
    if (!server) GTEST_SKIP() << "no X server: install xvfb";
    for (const bool egl : {false, true}) {
        SCOPED_TRACE(egl ? "EGL" : "GLX");
        std::vector<std::string> arguments{LUMO_EMBED_GL, "--check-state", "--width",
                                           "160",         "--height",      "90"};
        if (egl) arguments.emplace_back("--egl");
        Process host(arguments);
        const XWindow window = server->find("embed-gl");
        ASSERT_NE(window, 0u);
        const auto lit = [&] {
            for (int i = 0; i < 500; ++i) {
                const auto shot = server->screenshot(window);
                // The wall that faces away from the sun.
                if (shot && shot->width == 160 && (shot->at(16, 45) & 0xff) > 40) return true;
                std::this_thread::sleep_for(10ms);
            }
            return false;
        };
        EXPECT_TRUE(lit());
        server->close(window);
        EXPECT_EQ(host.exit_code(), 0);
    }
}

/// The host's swapchain, between whose images lumo works on the same queue.
TEST(EmbedVulkanTest, ShowsInItsWindowWhatItSaves) {
    const auto server = XServer::start();
    if (!server) GTEST_SKIP() << "no X server: install xvfb";
    const auto file =
        std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + ".embed-vulkan.png");
    Process host({LUMO_EMBED_VULKAN, "--validation", "--check", "--width", "160", "--height", "90", "-o",
                  file.string()});
    const XWindow window = server->find("embed-vulkan");
    ASSERT_NE(window, 0u);
    std::optional<Picture> shot;
    for (int i = 0; i < 500; ++i) {
        shot = server->screenshot(window);
        // The wall that faces away from the sun.
        if (shot && shot->width == 160 && (shot->at(150, 40) >> 8 & 0xff) > 30) break;
        std::this_thread::sleep_for(10ms);
    }
    server->close(window);
    EXPECT_EQ(host.exit_code(), 0);
    const auto saved = scene::read_image8(file);
    std::filesystem::remove(file);
    ASSERT_TRUE(saved) << to_string(saved.error());
    ASSERT_TRUE(shot);
    EXPECT_TRUE(picture_of(*saved) == *shot) << "the file differs from the screen";
}

TEST_P(SampleTest, ComputeSquaresNumbers) {
    const auto output = file(".compute.txt");
    EXPECT_EQ(Process({"/bin/sh", "-c",
                       std::string(LUMO_COMPUTE) + " --api " + GetParam() + " --count 70 > '" +
                           output.string() + "'"})
                  .exit_code(),
              0);
    std::ostringstream text;
    text << std::ifstream(output).rdbuf();
    std::filesystem::remove(output);
    for (const char* line : {"\n1 squared is 1\n", "\n12 squared is 144\n", "\n70 squared is 4900\n"})
        EXPECT_THAT(text.str(), HasSubstr(line));
}

}  // namespace
}  // namespace lumo::testing_support
