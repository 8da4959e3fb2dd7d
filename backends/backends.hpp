// Making devices: the one place where an API is named by those who use lumo.
#pragma once

#include <vector>

#include "rhi/rhi.hpp"

namespace lumo::backends {

/// A device of this API. Errors: no_device (with what was found), unsupported (what the device lacks).
Result<rhi::Device> create_device(rhi::Api api, const rhi::DeviceDesc& desc = {});

/// Every device that this API finds; empty when its loader or drivers are missing.
std::vector<rhi::DeviceInfo> list_devices(rhi::Api api);

}  // namespace lumo::backends
