// Vulkan 1.3.
#pragma once

#include <memory>
#include <vector>

#include "backends/surface.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::vulkan {

struct HostDevice;

/// Without a surface, without any surface extension.
Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc,
                                                     std::shared_ptr<const Surface> surface);
/// On a host's device.
Result<std::unique_ptr<rhi::Backend>> adopt_backend(const HostDevice& host, const rhi::DeviceDesc& desc);
std::vector<rhi::DeviceInfo> list_devices();

}  // namespace lumo::backends::vulkan
