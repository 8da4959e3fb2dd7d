// Making devices: the one place where an API is named by those who use lumo.
#pragma once

#include <memory>
#include <vector>

#include "rhi/rhi.hpp"

namespace lumo::backends {

struct Surface;

/// A device of this API; with a surface, one that presents into it (backends/window.hpp). Errors: no_device
/// (with what was found), unsupported (what the device lacks).
Result<rhi::Device> create_device(rhi::Api api, const rhi::DeviceDesc& desc = {},
                                  std::shared_ptr<const Surface> surface = {});

/// Every device that this API finds; empty when its loader or drivers are missing.
std::vector<rhi::DeviceInfo> list_devices(rhi::Api api);

}  // namespace lumo::backends
