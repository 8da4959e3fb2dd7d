// The host's context: a GLFW window's, or one of EGL's without a window.
#pragma once

struct GLFWwindow;

namespace embed {

struct ContextDesc {
    int width = 960, height = 540;
    bool headless = false;
    bool egl = false;  ///< GLFW makes the context by EGL instead of the window system's own way
};

/// OpenGL 4.5 core, a debug context; current on this thread while it lives.
class Context {
  public:
    /// Throws std::runtime_error where there is none.
    explicit Context(const ContextDesc& desc);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    bool should_close() const;
    void swap() const;

  private:
    void open_window(const ContextDesc& desc);
    void open_headless();

    GLFWwindow* window_ = nullptr;
    void* egl_display_ = nullptr;  ///< EGLDisplay and EGLContext
    void* egl_context_ = nullptr;
};

}  // namespace embed
