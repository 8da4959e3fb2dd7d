// The Vulkan loader, one instance of it, and the way of its messages to the sink.
#pragma once

#include <memory>
#include <span>
#include <vector>
#include <vulkan/vulkan.h>

#include "rhi/check.hpp"
#include "rhi/error.hpp"

namespace lumo::backends::vulkan {

/// All that one of Vulkan's enumerations gives: `call` takes a pointer to the count and one to the elements.
template <class T, class Call>
std::vector<T> enumerate(Call&& call) {
    uint32_t count = 0;
    call(&count, nullptr);
    std::vector<T> elements(count);
    call(&count, elements.data());
    elements.resize(count);
    return elements;
}

/// Functions of one instance, in no global variable, as device_table.hpp says.
struct InstanceTable {
    PFN_vkDestroyInstance destroy_instance;
    PFN_vkEnumeratePhysicalDevices enumerate_physical_devices;
    PFN_vkEnumerateDeviceExtensionProperties device_extensions;
    PFN_vkGetPhysicalDeviceProperties2 properties;
    PFN_vkGetPhysicalDeviceFeatures2 features;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties queue_families;
    PFN_vkGetPhysicalDeviceMemoryProperties2 memory_properties;
    PFN_vkGetPhysicalDeviceFormatProperties2 format_properties;
    PFN_vkGetPhysicalDeviceImageFormatProperties2 image_format_properties;
    PFN_vkCreateDevice create_device;
    PFN_vkGetDeviceProcAddr get_device_proc_addr;
    // VK_KHR_surface; null without it.
    PFN_vkDestroySurfaceKHR destroy_surface;
    PFN_vkGetPhysicalDeviceSurfaceSupportKHR surface_support;
    PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR surface_capabilities;
    PFN_vkGetPhysicalDeviceSurfaceFormatsKHR surface_formats;
    PFN_vkGetPhysicalDeviceSurfacePresentModesKHR present_modes;
    // VK_EXT_debug_utils; null without it.
    PFN_vkCreateDebugUtilsMessengerEXT create_messenger;
    PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger;
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label;
    PFN_vkCmdEndDebugUtilsLabelEXT end_label;
};

class Instance {
  public:
    /// With `validation` the Khronos layer is on, synchronization validation included. `surfaces`: the
    /// extensions for those of a window. Errors: no_device (no loader, or no driver that can make an
    /// instance), unsupported (the layer or Vulkan 1.3 is missing).
    static Result<std::unique_ptr<Instance>> create(bool validation, rhi::MessageSink sink,
                                                    std::span<const char* const> surfaces);
    /// A host's, by its own loader; messages are the host's matter. Error: unsupported (a function is missing).
    static Result<std::unique_ptr<Instance>> adopt(PFN_vkGetInstanceProcAddr get, VkInstance instance,
                                                   rhi::MessageSink sink);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    const InstanceTable& vk() const { return table_; }
    VkInstance handle() const { return instance_; }
    std::vector<VkPhysicalDevice> physical_devices() const;
    /// To the sink, or failures to stderr where there is none.
    void report(const rhi::Message& message) const;

  private:
    explicit Instance(rhi::MessageSink sink) : sink_(std::move(sink)) {}
    void load(PFN_vkGetInstanceProcAddr get);

    rhi::MessageSink sink_;
    VkInstance instance_ = VK_NULL_HANDLE;
    bool adopted_ = false;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    InstanceTable table_{};
};

}  // namespace lumo::backends::vulkan
