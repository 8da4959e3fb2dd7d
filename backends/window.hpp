// Windows, by GLFW. A frame is drawn into textures as without a window; Commands::present shows one.
//
//     auto window = Window::open(rhi::Api::vulkan, {.title = "triangle"});
//     auto device = window->create_device();
//     while (!window->should_close()) {
//         window->poll();
//         …
//         commands.present(picture);
//     }
#pragma once

#include <memory>
#include <string>

#include "backends/backends.hpp"

struct GLFWwindow;

namespace lumo::backends {

struct WindowDesc {
    std::string title = "lumo";
    uint32_t width = 960;  ///< screen coordinates: pixels, but where the desktop scales
    uint32_t height = 540;
    bool resizable = true;
};

/// Used on the main thread alone. The devices made for it keep it open, so either may go first.
class Window {
  public:
    /// For one API, because a window system may want to know. Errors: no_device (no display, or none of this
    /// API).
    static Result<Window> open(rhi::Api api, const WindowDesc& desc = {});

    /// The device that draws into this window: one at a time. Errors as backends::create_device.
    Result<rhi::Device> create_device(const rhi::DeviceDesc& desc = {}) const;

    /// Pixels of the area that is drawn into; zeros while minimised.
    rhi::Extent size() const;
    /// Screen coordinates. The window's system may disagree; size() tells.
    void resize(uint32_t width, uint32_t height);
    /// Takes what happened to it since; the callbacks of the handle are called from here.
    void poll();
    /// The same, after waiting until something happens: for while there is nothing to draw.
    void wait();
    bool should_close() const;

    /// For input and what else GLFW has.
    GLFWwindow* handle() const { return window_.get(); }

  private:
    Window(rhi::Api api, std::shared_ptr<GLFWwindow> window) : api_(api), window_(std::move(window)) {}

    rhi::Api api_;
    std::shared_ptr<GLFWwindow> window_;
};

}  // namespace lumo::backends
