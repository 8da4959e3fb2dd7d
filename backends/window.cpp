#include "backends/window.hpp"

#include <EGL/egl.h>
#include <fmt/format.h>
#include <vulkan/vulkan_core.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#define GLFW_EXPOSE_NATIVE_EGL
#include <GLFW/glfw3native.h>

#include "backends/surface.hpp"

namespace lumo::backends {
namespace {

/// What GLFW last complained of.
tl::unexpected<Error> glfw_error(std::string_view what) {
    const char* why = nullptr;
    glfwGetError(&why);
    return fail(ErrorKind::no_device, "window", fmt::format("{}: {}", what, why ? why : "no reason given"),
                "set DISPLAY to a running X server, or draw without a window");
}

/// GLFW itself, for as long as a window is open.
struct Library {
    Library() = default;
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    ~Library() { glfwTerminate(); }

    static Result<std::shared_ptr<Library>> get() {
        static std::weak_ptr<Library> open;
        if (auto library = open.lock()) return library;
        if (!glfwInit()) return glfw_error("GLFW does not start");
        auto library = std::make_shared<Library>();
        open = library;
        return library;
    }
};

rhi::Extent size_of(GLFWwindow* window) {
    if (glfwGetWindowAttrib(window, GLFW_ICONIFIED)) return {0, 0, 1};
    int width = 0, height = 0;
    glfwGetFramebufferSize(window, &width, &height);
    return {uint32_t(width), uint32_t(height), 1};
}

}  // namespace

Result<Window> Window::open(rhi::Api api, const WindowDesc& desc) {
    auto library = Library::get();
    if (!library) return tl::unexpected(library.error());
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_RESIZABLE, desc.resizable);
    if (api == rhi::Api::vulkan) {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    } else {
        // For the surface alone: the device makes a context of its own for it, like those without a window.
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
        for (int unused : {GLFW_ALPHA_BITS, GLFW_DEPTH_BITS, GLFW_STENCIL_BITS}) glfwWindowHint(unused, 0);
    }
    GLFWwindow* window =
        glfwCreateWindow(int(desc.width), int(desc.height), desc.title.c_str(), nullptr, nullptr);
    if (!window) return glfw_error(fmt::format("no window of {}x{}", desc.width, desc.height));
    return Window(api, {window, [library = *library](GLFWwindow* closed) { glfwDestroyWindow(closed); }});
}

Result<rhi::Device> Window::create_device(const rhi::DeviceDesc& desc) const {
    auto surface = std::make_shared<Surface>();
    surface->size = [window = window_] { return size_of(window.get()); };
    if (api_ == rhi::Api::gl) {
        surface->egl_display = glfwGetEGLDisplay();
        surface->egl_surface = glfwGetEGLSurface(window_.get());
        return backends::create_device(api_, desc, std::move(surface));
    }
    uint32_t count = 0;
    const char** extensions = glfwGetRequiredInstanceExtensions(&count);
    if (!extensions) return glfw_error("no Vulkan on this display");
    surface->instance_extensions.assign(extensions, extensions + count);
    surface->create_vulkan_surface = [window = window_](void* instance) -> Result<uint64_t> {
        VkSurfaceKHR made = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(static_cast<VkInstance>(instance), window.get(), nullptr, &made) !=
            VK_SUCCESS)
            return glfw_error("no surface for Vulkan");
        return reinterpret_cast<uint64_t>(made);
    };
    return backends::create_device(api_, desc, std::move(surface));
}

rhi::Extent Window::size() const { return size_of(window_.get()); }
void Window::resize(uint32_t width, uint32_t height) {
    glfwSetWindowSize(window_.get(), int(width), int(height));
}
void Window::poll() { glfwPollEvents(); }
void Window::wait() { glfwWaitEvents(); }
bool Window::should_close() const { return glfwWindowShouldClose(window_.get()); }

}  // namespace lumo::backends
