// A physical device as it looks before a logical one is made of it or taken from a host.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backends/vulkan/features.hpp"
#include "backends/vulkan/instance.hpp"
#include "rhi/device_info.hpp"
#include "rhi/error.hpp"

namespace lumo::backends::vulkan {

/// What may be used of a device: all that it has, or what its host enabled.
struct Usable {
    std::vector<std::string> extensions;
    Features features;
};

struct Candidate {
    VkPhysicalDevice device = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceDriverProperties driver{};
    Features features;
    bool push_descriptors = false;
    bool budget = false;
    std::optional<uint32_t> queue_family;
    uint32_t timestamp_bits = 0;
    std::vector<std::string> lacks;  ///< of what lumo needs

    std::string_view name() const { return properties.deviceName; }
};

/// With a surface, as a device that presents to it.
Candidate look_at(const Instance& instance, VkPhysicalDevice device, VkSurfaceKHR surface = VK_NULL_HANDLE);
/// As the device of a host, and this family of its queues.
Candidate look_at(const Instance& instance, VkPhysicalDevice device, const Usable& usable,
                  uint32_t queue_family);

/// The best device, or the best whose name holds `name`. Errors: no_device (with what was found), unsupported
/// (with what the device lacks).
Result<Candidate> choose(const Instance& instance, std::string_view name, VkSurfaceKHR surface);
/// Whether a device's name holds `part`, without case.
bool has_name(const Candidate& candidate, std::string_view part);

rhi::DeviceInfo describe(const Candidate& candidate);

}  // namespace lumo::backends::vulkan
