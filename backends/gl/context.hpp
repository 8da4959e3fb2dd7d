// An OpenGL 4.5 core context, through EGL, headless or for a window, and what its driver says about itself.
#pragma once

#include <array>
#include <epoxy/gl.h>
#include <memory>
#include <vector>

#include "backends/surface.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// EGL's or GLX's way to ask for the current context.
using CurrentContext = void* (*)();

/// An own context or a host's. Its thread is the one that opened it: a context is current on one thread at a time,
/// and several own contexts of one thread take turns.
class Context {
  public:
    /// The first device whose GL_RENDERER contains desc.name (case ignored); without a name the first that is
    /// not software, else the first. The context is current afterwards. With a surface, the device is the one of
    /// its display. Errors: no_device, with what was found.
    static Result<std::unique_ptr<Context>> open(const rhi::DeviceDesc& desc,
                                                 const std::shared_ptr<const Surface>& surface);

    /// The host's that is current. Errors: no_device, with what is there instead of OpenGL 4.5 core.
    static Result<std::unique_ptr<Context>> adopt(const rhi::DeviceDesc& desc);

    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    /// The objects of an own context go with it.
    ~Context();

    bool is_hosts() const { return hosts_ != nullptr; }
    /// To be called before any of OpenGL. An own context is made current, cheaply where it is already. A host's has
    /// to be, else the error is invalid_argument.
    Result<void> enter() const;
    /// Takes out the errors that the host did not read, lest they be taken for lumo's.
    void drop_hosts_errors() const;

    /// With validation, the driver's messages go to the sink from here on; in a host's context only until
    /// stop_listening, and only where the host has no callback of its own.
    void listen();
    void stop_listening();

    const rhi::DeviceInfo& info() const { return info_; }
    /// Null without a window.
    const Surface* surface() const { return surface_.get(); }
    /// Shows what was drawn into the window's back buffer. Error: device_lost, where the window takes no frame.
    Result<void> swap(bool vsync);

    /// The EGLDisplay and EGLContext, by pointer so that EGL's headers stay out of this one.
    Context(void* display, void* context, std::shared_ptr<const Surface> surface);
    explicit Context(CurrentContext hosts);

  private:
    void make_current() const;
    void describe(const rhi::DeviceDesc& desc);

    CurrentContext hosts_ = nullptr;  ///< null: own
    void* display_ = nullptr;
    void* context_;
    std::shared_ptr<const Surface> surface_;
    int interval_ = 1;  ///< EGL's own at first
    rhi::DeviceInfo info_;
    rhi::MessageSink sink_;
    bool listening_ = false;
    std::array<bool, 2> hosts_debug_{};  ///< what was enabled before listening
};

/// A device for every EGL display that can make a context.
std::vector<rhi::DeviceInfo> found_devices();

}  // namespace lumo::backends::gl
