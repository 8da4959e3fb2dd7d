#include "samples/embed-gl/context.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <array>
#include <stdexcept>
#include <string>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace embed {

Context::Context(const ContextDesc& desc) {
    if (desc.headless) {
        open_headless();
    } else {
        open_window(desc);
    }
}

Context::~Context() {
    if (window_) {
        glfwDestroyWindow(window_);
        glfwTerminate();
    } else {
        eglMakeCurrent(egl_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(egl_display_, egl_context_);
        eglTerminate(egl_display_);
    }
}

void Context::open_window(const ContextDesc& desc) {
    if (!glfwInit()) throw std::runtime_error("there is no window system; --headless does without");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, desc.egl ? GLFW_EGL_CONTEXT_API : GLFW_NATIVE_CONTEXT_API);
    window_ = glfwCreateWindow(desc.width, desc.height, "embed-gl", nullptr, nullptr);
    if (!window_) {
        const char* why = nullptr;
        glfwGetError(&why);
        throw std::runtime_error(std::string("no window: ") + (why ? why : "no reason given"));
    }
    glfwMakeContextCurrent(window_);
}

void Context::open_headless() {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    const auto query_devices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint devices = 0;
    if (get_display && query_devices && query_devices(1, &device, &devices) && devices > 0)
        egl_display_ = get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    if (!egl_display_ || !eglInitialize(egl_display_, nullptr, nullptr))
        throw std::runtime_error("EGL has no device to draw on without a window");
    eglBindAPI(EGL_OPENGL_API);
    const std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           4,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           5,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_CONTEXT_OPENGL_DEBUG,
                                           EGL_TRUE,
                                           EGL_NONE};
    egl_context_ = eglCreateContext(egl_display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (!egl_context_ || !eglMakeCurrent(egl_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, egl_context_))
        throw std::runtime_error("EGL makes no OpenGL 4.5 context");
}

bool Context::should_close() const { return window_ && glfwWindowShouldClose(window_); }

void Context::swap() const {
    if (!window_) return;
    glfwSwapBuffers(window_);
    glfwPollEvents();
}

}  // namespace embed
