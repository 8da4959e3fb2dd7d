// OpenGL 4.5 core.
#pragma once

#include <memory>
#include <vector>

#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// Headless, by EGL device enumeration, then surfaceless.
Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc);
std::vector<rhi::DeviceInfo> list_devices();

}  // namespace lumo::backends::gl
