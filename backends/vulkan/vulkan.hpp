// Vulkan 1.3.
#pragma once

#include <memory>
#include <vector>

#include "rhi/backend.hpp"

namespace lumo::backends::vulkan {

/// Headless: no surface extension.
Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc);
std::vector<rhi::DeviceInfo> list_devices();

}  // namespace lumo::backends::vulkan
