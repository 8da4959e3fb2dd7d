#include "backends/vulkan/adopt.hpp"

#include "backends/vulkan/features.hpp"
#include "backends/vulkan/vulkan.hpp"

namespace lumo::backends::vulkan {

Result<rhi::Device> adopt_device(const HostDevice& host, const rhi::DeviceDesc& desc) {
    return adopt_backend(host, desc).map([&](std::unique_ptr<rhi::Backend> made) {
        return rhi::Device(std::move(made), desc);
    });
}

std::vector<Requirement> requirements() {
    std::vector<Requirement> all;
    for (const Feature& feature : used_features())
        all.push_back({feature.name, feature.purpose, feature.required});
    all.push_back({VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME, "fewer calls a dispatch or draw", false});
    all.push_back({VK_EXT_MEMORY_BUDGET_EXTENSION_NAME, "Device::memory_budget", false});
    return all;
}

}  // namespace lumo::backends::vulkan
