// What a backend asks of a window. backends/window.hpp gives it for GLFW's windows; those of another toolkit
// fit as well.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "rhi/error.hpp"
#include "rhi/resources.hpp"

namespace lumo::backends {

/// The area of a window that is drawn into. A device keeps it, and so the window, alive. The handles are those
/// of EGL and Vulkan, whose headers this one does without.
struct Surface {
    /// Pixels; zeros while nothing of it shows, as when minimised.
    std::function<rhi::Extent()> size;

    // OpenGL
    void* egl_display = nullptr;  ///< EGLDisplay, initialised
    void* egl_surface = nullptr;  ///< EGLSurface of the window, with two buffers

    // Vulkan
    std::vector<const char*> instance_extensions = {};
    /// Makes a VkSurfaceKHR of a VkInstance that has these extensions. Error: unsupported.
    std::function<Result<uint64_t>(void* instance)> create_vulkan_surface = {};
};

}  // namespace lumo::backends
