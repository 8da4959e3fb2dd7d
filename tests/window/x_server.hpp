// An X server of a test's own, without a screen, and what is seen and done in it from outside: as another
// program that looks at the screen, and as the window manager.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

struct _XDisplay;  // NOLINT(bugprone-reserved-identifier): Xlib names it so

namespace lumo::testing_support {

using XWindow = unsigned long;

/// What the screen shows, row 0 at the top, as 0xRRGGBB.
struct Picture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint32_t> pixels = {};

    uint32_t at(uint32_t x, uint32_t y) const { return pixels[size_t(y) * width + x]; }
    bool operator==(const Picture&) const = default;
};

/// Xvfb, as DISPLAY of this process and its children while it lives.
class XServer {
  public:
    static constexpr uint32_t width = 800, height = 600;

    /// None where Xvfb is not installed or does not start, which is a test failure where the environment has
    /// LUMO_REQUIRE_APIS=1.
    static std::unique_ptr<XServer> start();
    ~XServer();
    XServer(const XServer&) = delete;
    XServer& operator=(const XServer&) = delete;

    /// The window of this title, once it is there.
    XWindow find(const std::string& title) const;
    /// The part of the screen where the window is; none while it is not wholly on the screen.
    std::optional<Picture> screenshot(XWindow window) const;
    void resize(XWindow window, uint32_t width, uint32_t height) const;
    void minimise(XWindow window) const;
    void restore(XWindow window) const;
    /// Presses its close button.
    void close(XWindow window) const;

  private:
    XServer(pid_t process, _XDisplay* display) : process_(process), display_(display) {}
    static std::unique_ptr<XServer> try_start();
    void set_state(XWindow window, long state) const;

    pid_t process_;
    _XDisplay* display_;
};

}  // namespace lumo::testing_support
