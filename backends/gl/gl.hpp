// OpenGL 4.5 core.
#pragma once

#include <memory>
#include <vector>

#include "backends/surface.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// Headless, by EGL device enumeration, then surfaceless. A device is used on the thread that made it;
/// several of one thread may be used in turn. Its context stays current on that thread until another is made
/// so. With a surface, on its display, and presenting into it. Errors: no_device, with what was found.
Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc,
                                                     const std::shared_ptr<const Surface>& surface);
std::vector<rhi::DeviceInfo> list_devices();

}  // namespace lumo::backends::gl
