// lumo on the Vulkan device of a host of another making: an engine, an editor, a test that makes calls fail.
//
// The host keeps what is its own. lumo makes its objects beside the host's, submits to the host's queue, waits for
// its own work alone, and destroys only what it made; every call goes through functions that the host's
// get_instance_proc_addr gave. Textures and semaphores go back and forth by rhi/native.hpp; docs/porting.md walks
// through a host.
//
// Threads: a call of lumo's that submits (Device::submit, the end of Commands, Device::upload and download) uses
// the queue, and no other thread may use it meanwhile. Between such calls it is the host's.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>
#include <vulkan/vulkan_core.h>

#include "rhi/rhi.hpp"

namespace lumo::backends::vulkan {

/// A host's device. Its handles outlive the lumo device; pointers are read by adopt_device alone.
struct HostDevice {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    uint32_t api_version = 0;  ///< VkApplicationInfo's, when the instance was made: 1.3 or later
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;  ///< for graphics and compute
    uint32_t queue_family = 0;
    /// What the device was made with, which Vulkan does not tell: `features` holds those of
    /// VkDeviceCreateInfo::pEnabledFeatures or of the VkPhysicalDeviceFeatures2 in its chain, and pNext the rest
    /// of that chain. Structures of Vulkan 1.2, of 1.3, and of single features are understood.
    const VkPhysicalDeviceFeatures2* features = nullptr;
    std::span<const char* const> extensions = {};  ///< VkDeviceCreateInfo::ppEnabledExtensionNames
};

/// A lumo device on the host's. Of `desc`, `name` must be part of the host's device's name; `validation` stays
/// false, because the layers and their messages are the host's. Errors: invalid_argument (a member of `host` is
/// not set), unsupported (with each feature and extension that is missing), no_device (another name).
Result<rhi::Device> adopt_device(const HostDevice& host, const rhi::DeviceDesc& desc = {});

/// A feature or an extension that lumo uses of a host's device, by Vulkan's name of it.
struct Requirement {
    std::string_view name;
    std::string_view purpose;
    bool required = false;  ///< else lumo does without it, or refuses what its purpose says
};
/// All of them, those that are required first. Besides: Vulkan 1.3, and a queue for graphics and compute.
std::vector<Requirement> requirements();

}  // namespace lumo::backends::vulkan
