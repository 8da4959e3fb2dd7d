// An OpenGL 4.5 core context, through EGL, headless or for a window, and what its driver says about itself.
#pragma once

#include <epoxy/gl.h>
#include <memory>
#include <vector>

#include "backends/surface.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// An own context. Its thread is the one that opened it: a context is current on one thread
/// at a time, and several contexts of one thread take turns through make_current.
class Context {
  public:
    /// The first device whose GL_RENDERER contains desc.name (case ignored); without a name the first that is
    /// not software, else the first. The context is current afterwards, in the state that the backend
    /// expects. With a surface, the device is the one of its display. Errors: no_device, with what was found.
    static Result<std::unique_ptr<Context>> open(const rhi::DeviceDesc& desc,
                                                 const std::shared_ptr<const Surface>& surface);

    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    /// The objects of the context go with it.
    ~Context();

    /// Does nothing, cheaply, where the context is current already.
    void make_current() const;

    const rhi::DeviceInfo& info() const { return info_; }
    /// Null without a window.
    const Surface* surface() const { return surface_.get(); }
    /// Shows what was drawn into the window's back buffer.
    Result<void> swap(bool vsync);

    /// The EGLDisplay and EGLContext, by pointer so that EGL's headers stay out of this one.
    Context(void* display, void* context, std::shared_ptr<const Surface> surface);

  private:
    void report_to(rhi::MessageSink sink);

    void* display_;
    void* context_;
    std::shared_ptr<const Surface> surface_;
    int interval_ = 1;  ///< EGL's own at first
    rhi::DeviceInfo info_;
    rhi::MessageSink sink_;
};

/// A device for every EGL display that can make a context.
std::vector<rhi::DeviceInfo> found_devices();

}  // namespace lumo::backends::gl
