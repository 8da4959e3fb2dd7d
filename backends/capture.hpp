// One frame for RenderDoc, the debugger of graphics.
#pragma once

#include <filesystem>

#include "rhi/error.hpp"

namespace lumo::backends {

/// All that the process's one device is given from start to finish. The process has to run under RenderDoc, which
/// wraps the APIs before a device is made; where it does not, nothing of it is loaded.
class Capture {
  public:
    /// Errors: unsupported, where RenderDoc is not loaded or has no device to capture.
    static Result<Capture> start();
    /// Writes the capture to `file`, in place of what was there. Errors: io; unsupported, where RenderDoc could not
    /// capture what it saw.
    Result<void> finish(const std::filesystem::path& file);

    Capture(Capture&& other) noexcept;
    Capture& operator=(Capture&&) = delete;
    /// What was not finished is dropped.
    ~Capture();

  private:
    explicit Capture(void* renderdoc) : renderdoc_(renderdoc) {}
    void* renderdoc_;  ///< its table of functions, by pointer so that its header stays out of this one
};

}  // namespace lumo::backends
