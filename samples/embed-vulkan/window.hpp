// The host's window: GLFW, and a swapchain that its picture is copied into.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "samples/embed-vulkan/host.hpp"

struct GLFWwindow;

namespace embed {

/// Of a fixed size, so that the host's images keep theirs.
class Window {
  public:
    Window(const std::string& title, uint32_t width, uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    std::span<const char* const> instance_extensions() const;
    VkSurfaceKHR make_surface(VkInstance instance) const;
    void poll();
    bool should_close() const;

  private:
    GLFWwindow* window_;
};

class WindowTarget {
  public:
    WindowTarget(const Window& window, const Host& host);
    ~WindowTarget();
    WindowTarget(const WindowTarget&) = delete;
    WindowTarget& operator=(const WindowTarget&) = delete;

    /// The host's picture as it is; waits for the screen.
    void show(Host& host);

  private:
    const Host& host_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    std::vector<VkImage> images_;
    VkExtent2D extent_{};
    VkSemaphore free_ = VK_NULL_HANDLE;
    std::vector<VkSemaphore> drawn_;  ///< one an image
};

}  // namespace embed
