// Vulkan's functions, replaced by ones that can fail where the loader's first function is looked up: the
// linker sends every dlsym of the program here (--wrap=dlsym).
#include <algorithm>
#include <tuple>
#include <type_traits>
#include <vulkan/vulkan.h>

#include "tests/support/faults.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier): the linker chooses these names
extern "C" void* __real_dlsym(void* library, const char* name);
extern "C" void* __wrap_dlsym(void* library, const char* name);
// NOLINTEND(bugprone-reserved-identifier)

namespace lumo::testing_support {
namespace {

bool installed = false;
PFN_vkGetInstanceProcAddr real_instance_proc = nullptr;
PFN_vkGetDeviceProcAddr real_device_proc = nullptr;

/// "Buffer" of vkCreateBuffer and vkDestroyBuffer.
constexpr std::string_view kind_of(std::string_view function) {
    if (function.ends_with("Pipelines")) return "Pipeline";
    for (std::string_view verb : {"vkCreate", "vkDestroy", "vkAllocate", "vkFree"})
        if (function.starts_with(verb)) return function.substr(verb.size());
    return {};
}

/// Those that a lost device shows itself by.
constexpr bool may_lose(std::string_view function) {
    return function == "vkQueueSubmit2" || function == "vkWaitSemaphores" ||
           function == "vkGetSemaphoreCounterValue" || function == "vkQueueWaitIdle" ||
           function == "vkQueuePresentKHR" || function == "vkAcquireNextImageKHR";
}

template <FunctionName name, class Function>
struct Hook;
template <FunctionName name, class Result, class... Arguments>
struct Hook<name, Result (*)(Arguments...)> {
    static inline Result (*real)(Arguments...) = nullptr;

    static Result call(Arguments... arguments) {
        constexpr std::string_view function = name.view();
        if constexpr (std::is_void_v<Result>) {
            static_assert(sizeof...(Arguments) == 3, "a device, an object of it, an allocator");
            if (std::get<1>(std::tie(arguments...)) != VK_NULL_HANDLE) faults().count(kind_of(function), -1);
            real(arguments...);
        } else {
            if (may_lose(function) && faults().lost(function)) {
                // What runs on the device, which is not lost in truth, must end before its objects go.
                if (function == "vkQueueWaitIdle") (void)real(arguments...);
                return VK_ERROR_DEVICE_LOST;
            }
            if (faults().fails(function))
                return faults().refuses() ? VK_ERROR_INVALID_SHADER_NV : VK_ERROR_OUT_OF_DEVICE_MEMORY;
            const Result result = real(arguments...);
            constexpr bool counts = function.starts_with("vkCreate") || function == "vkAllocateMemory";
            constexpr bool of_device = function != "vkCreateInstance" && function != "vkCreateDevice";
            if (counts && of_device && result == VK_SUCCESS) faults().count(kind_of(function), 1);
            return result;
        }
    }
    static bool put_in(std::string_view function, PFN_vkVoidFunction& found) {
        if (function != name.view()) return false;
        real = reinterpret_cast<Result (*)(Arguments...)>(found);
        found = reinterpret_cast<PFN_vkVoidFunction>(&call);
        return true;
    }
};

template <FunctionName... names, class... Functions>
bool replace(std::string_view function, PFN_vkVoidFunction& found, std::tuple<Hook<names, Functions>...>) {
    return (Hook<names, Functions>::put_in(function, found) || ...);
}

using InstanceHooks =
    std::tuple<Hook<"vkCreateInstance", PFN_vkCreateInstance>, Hook<"vkCreateDevice", PFN_vkCreateDevice>>;
using DeviceHooks = std::tuple<
    Hook<"vkCreateBuffer", PFN_vkCreateBuffer>, Hook<"vkDestroyBuffer", PFN_vkDestroyBuffer>,
    Hook<"vkCreateImage", PFN_vkCreateImage>, Hook<"vkDestroyImage", PFN_vkDestroyImage>,
    Hook<"vkCreateImageView", PFN_vkCreateImageView>, Hook<"vkDestroyImageView", PFN_vkDestroyImageView>,
    Hook<"vkCreateSampler", PFN_vkCreateSampler>, Hook<"vkDestroySampler", PFN_vkDestroySampler>,
    Hook<"vkAllocateMemory", PFN_vkAllocateMemory>, Hook<"vkFreeMemory", PFN_vkFreeMemory>,
    Hook<"vkMapMemory", PFN_vkMapMemory>, Hook<"vkBindBufferMemory", PFN_vkBindBufferMemory>,
    Hook<"vkBindImageMemory", PFN_vkBindImageMemory>, Hook<"vkCreateShaderModule", PFN_vkCreateShaderModule>,
    Hook<"vkDestroyShaderModule", PFN_vkDestroyShaderModule>,
    Hook<"vkCreateDescriptorSetLayout", PFN_vkCreateDescriptorSetLayout>,
    Hook<"vkDestroyDescriptorSetLayout", PFN_vkDestroyDescriptorSetLayout>,
    Hook<"vkCreateDescriptorPool", PFN_vkCreateDescriptorPool>,
    Hook<"vkDestroyDescriptorPool", PFN_vkDestroyDescriptorPool>,
    Hook<"vkAllocateDescriptorSets", PFN_vkAllocateDescriptorSets>,
    Hook<"vkCreatePipelineLayout", PFN_vkCreatePipelineLayout>,
    Hook<"vkDestroyPipelineLayout", PFN_vkDestroyPipelineLayout>,
    Hook<"vkCreatePipelineCache", PFN_vkCreatePipelineCache>,
    Hook<"vkDestroyPipelineCache", PFN_vkDestroyPipelineCache>,
    Hook<"vkCreateComputePipelines", PFN_vkCreateComputePipelines>,
    Hook<"vkCreateGraphicsPipelines", PFN_vkCreateGraphicsPipelines>,
    Hook<"vkDestroyPipeline", PFN_vkDestroyPipeline>, Hook<"vkCreateCommandPool", PFN_vkCreateCommandPool>,
    Hook<"vkDestroyCommandPool", PFN_vkDestroyCommandPool>,
    Hook<"vkAllocateCommandBuffers", PFN_vkAllocateCommandBuffers>,
    Hook<"vkResetCommandPool", PFN_vkResetCommandPool>,
    Hook<"vkBeginCommandBuffer", PFN_vkBeginCommandBuffer>,
    Hook<"vkEndCommandBuffer", PFN_vkEndCommandBuffer>, Hook<"vkCreateQueryPool", PFN_vkCreateQueryPool>,
    Hook<"vkDestroyQueryPool", PFN_vkDestroyQueryPool>, Hook<"vkCreateSemaphore", PFN_vkCreateSemaphore>,
    Hook<"vkDestroySemaphore", PFN_vkDestroySemaphore>, Hook<"vkQueueSubmit2", PFN_vkQueueSubmit2>,
    Hook<"vkWaitSemaphores", PFN_vkWaitSemaphores>,
    Hook<"vkGetSemaphoreCounterValue", PFN_vkGetSemaphoreCounterValue>,
    Hook<"vkQueueWaitIdle", PFN_vkQueueWaitIdle>, Hook<"vkSignalSemaphore", PFN_vkSignalSemaphore>,
    Hook<"vkCreateSwapchainKHR", PFN_vkCreateSwapchainKHR>,
    Hook<"vkDestroySwapchainKHR", PFN_vkDestroySwapchainKHR>,
    Hook<"vkGetSwapchainImagesKHR", PFN_vkGetSwapchainImagesKHR>,
    Hook<"vkAcquireNextImageKHR", PFN_vkAcquireNextImageKHR>,
    Hook<"vkQueuePresentKHR", PFN_vkQueuePresentKHR>>;

PFN_vkEnumerateDeviceExtensionProperties real_extensions = nullptr;

VkResult extensions(VkPhysicalDevice device, const char* layer, uint32_t* count,
                    VkExtensionProperties* list) {
    const VkResult result = real_extensions(device, layer, count, list);
    if (!list || !faults().hides_push_descriptors()) return result;
    *count = uint32_t(std::remove_if(list, list + *count,
                                     [](const VkExtensionProperties& one) {
                                         return std::string_view(one.extensionName) ==
                                                VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
                                     }) -
                      list);
    return result;
}

PFN_vkVoidFunction device_proc(VkDevice device, const char* name) {
    PFN_vkVoidFunction found = real_device_proc(device, name);
    if (found && installed) replace(name, found, DeviceHooks());
    return found;
}

PFN_vkVoidFunction instance_proc(VkInstance instance, const char* name) {
    PFN_vkVoidFunction found = real_instance_proc(instance, name);
    if (!found || !installed) return found;
    if (std::string_view(name) == "vkGetDeviceProcAddr") {
        real_device_proc = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
        return reinterpret_cast<PFN_vkVoidFunction>(&device_proc);
    }
    if (std::string_view(name) == "vkEnumerateDeviceExtensionProperties") {
        real_extensions = reinterpret_cast<PFN_vkEnumerateDeviceExtensionProperties>(found);
        return reinterpret_cast<PFN_vkVoidFunction>(&extensions);
    }
    replace(name, found, InstanceHooks());
    return found;
}

}  // namespace

void install_vulkan_faults() { installed = true; }
void remove_vulkan_faults() { installed = false; }

}  // namespace lumo::testing_support

// NOLINTNEXTLINE(bugprone-reserved-identifier)
void* __wrap_dlsym(void* library, const char* name) {
    using namespace lumo::testing_support;
    void* found = __real_dlsym(library, name);
    if (!found || std::string_view(name) != "vkGetInstanceProcAddr") return found;
    real_instance_proc = reinterpret_cast<PFN_vkGetInstanceProcAddr>(found);
    return reinterpret_cast<void*>(&instance_proc);
}
