#include "backends/vulkan/instance.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <fmt/format.h>
#include <string_view>

namespace lumo::backends::vulkan {

namespace {

using rhi::Severity;

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

/// Null when there is no loader. Found once a process, and kept.
PFN_vkGetInstanceProcAddr loader() {
    static const PFN_vkGetInstanceProcAddr entry = []() -> PFN_vkGetInstanceProcAddr {
        for (const char* name : {"libvulkan.so.1", "libvulkan.so"})
            if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL))
                return reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
        return nullptr;
    }();
    return entry;
}

Severity severity_of(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT types,
                     std::string_view id) {
    if (severity < VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) return Severity::notification;
    // The loader complains about drivers and layers that are installed badly and not used.
    if (id == "Loader Message") return Severity::low;
    if (types & VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT) return Severity::performance;
    return severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT ? Severity::error : Severity::medium;
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT types,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* instance) {
    std::string id = data->pMessageIdName ? data->pMessageIdName : "";
    auto level = severity_of(severity, types, id);
    static_cast<const Instance*>(instance)->report(
        {.severity = level, .id = std::move(id), .text = data->pMessage ? data->pMessage : ""});
    return VK_FALSE;
}

}  // namespace

Result<std::unique_ptr<Instance>> Instance::create(bool validation, rhi::MessageSink sink,
                                                   std::span<const char* const> surfaces) {
    auto get = loader();
    if (!get) {
        return fail(ErrorKind::no_device, "Vulkan", "there is no Vulkan loader (libvulkan.so.1)",
                    "install the package libvulkan1 and a Vulkan driver, or use OpenGL");
    }
    auto load = [&]<class F>(F& function, VkInstance instance, const char* name) {
        function = reinterpret_cast<F>(get(instance, name));
    };
    PFN_vkEnumerateInstanceVersion version_of = nullptr;
    PFN_vkEnumerateInstanceLayerProperties layers_of = nullptr;
    PFN_vkEnumerateInstanceExtensionProperties extensions_of = nullptr;
    PFN_vkCreateInstance create_instance = nullptr;
    load(version_of, nullptr, "vkEnumerateInstanceVersion");
    load(layers_of, nullptr, "vkEnumerateInstanceLayerProperties");
    load(extensions_of, nullptr, "vkEnumerateInstanceExtensionProperties");
    load(create_instance, nullptr, "vkCreateInstance");

    uint32_t version = VK_API_VERSION_1_0;
    if (version_of) version_of(&version);
    if (version < VK_API_VERSION_1_3) {
        return fail(ErrorKind::unsupported, "Vulkan",
                    fmt::format("the loader is of Vulkan {}.{}, 1.3 is needed", VK_API_VERSION_MAJOR(version),
                                VK_API_VERSION_MINOR(version)),
                    "update the Vulkan loader");
    }
    if (validation) {
        auto layers = enumerate<VkLayerProperties>(layers_of);
        bool found = std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
            return std::string_view(layer.layerName) == validation_layer;
        });
        if (!found) {
            return fail(ErrorKind::unsupported, "Vulkan",
                        fmt::format("{} is not installed", validation_layer),
                        "install the package vulkan-validationlayers, or run without validation");
        }
    }
    auto available = enumerate<VkExtensionProperties>(
        [&](uint32_t* count, VkExtensionProperties* list) { extensions_of(nullptr, count, list); });
    bool debug_utils = std::any_of(available.begin(), available.end(), [](const VkExtensionProperties& e) {
        return std::string_view(e.extensionName) == VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    });

    std::unique_ptr<Instance> made(new Instance(std::move(sink)));
    std::vector<const char*> extensions(surfaces.begin(), surfaces.end());
    if (debug_utils) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (validation) extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = made.get(),
    };
    auto synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features{
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = debug_utils ? &messenger : nullptr,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = &synchronization,
    };
    VkApplicationInfo application{
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pEngineName = "lumo",
        .apiVersion = VK_API_VERSION_1_3,
    };
    VkInstanceCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validation ? static_cast<const void*>(&features) : features.pNext,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation ? 1u : 0u,
        .ppEnabledLayerNames = &validation_layer,
        .enabledExtensionCount = uint32_t(extensions.size()),
        .ppEnabledExtensionNames = extensions.data(),
    };
    VkResult result = create_instance(&info, nullptr, &made->instance_);
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return fail(ErrorKind::out_of_memory, "Vulkan", "there is no memory for an instance");
    if (result != VK_SUCCESS) {
        return fail(ErrorKind::no_device, "Vulkan",
                    fmt::format("no instance could be made (VkResult {})", int(result)),
                    "install a Vulkan driver, such as the package mesa-vulkan-drivers, or use OpenGL");
    }

    made->load(get);
    if (debug_utils) made->table_.create_messenger(made->instance_, &messenger, nullptr, &made->messenger_);
    return made;
}

Result<std::unique_ptr<Instance>> Instance::adopt(PFN_vkGetInstanceProcAddr get, VkInstance instance,
                                                  rhi::MessageSink sink) {
    std::unique_ptr<Instance> made(new Instance(std::move(sink)));
    made->instance_ = instance;
    made->adopted_ = true;
    made->load(get);
    const auto& vk = made->table_;
    const bool complete = vk.properties && vk.features && vk.queue_families && vk.memory_properties &&
                          vk.format_properties && vk.image_format_properties && vk.get_device_proc_addr;
    if (!complete) {
        return fail(ErrorKind::unsupported, "HostDevice",
                    "get_instance_proc_addr does not give the functions of a Vulkan 1.1 instance",
                    "make the host's instance for Vulkan 1.3");
    }
    return made;
}

/// What belongs to extensions that are not enabled stays null.
void Instance::load(PFN_vkGetInstanceProcAddr get) {
    auto load = [&]<class F>(F& function, const char* name) {
        function = reinterpret_cast<F>(get(instance_, name));
    };
    auto& vk = table_;
    load(vk.destroy_instance, "vkDestroyInstance");
    load(vk.enumerate_physical_devices, "vkEnumeratePhysicalDevices");
    load(vk.device_extensions, "vkEnumerateDeviceExtensionProperties");
    load(vk.properties, "vkGetPhysicalDeviceProperties2");
    load(vk.features, "vkGetPhysicalDeviceFeatures2");
    load(vk.queue_families, "vkGetPhysicalDeviceQueueFamilyProperties");
    load(vk.memory_properties, "vkGetPhysicalDeviceMemoryProperties2");
    load(vk.format_properties, "vkGetPhysicalDeviceFormatProperties2");
    load(vk.image_format_properties, "vkGetPhysicalDeviceImageFormatProperties2");
    load(vk.create_device, "vkCreateDevice");
    load(vk.get_device_proc_addr, "vkGetDeviceProcAddr");
    load(vk.destroy_surface, "vkDestroySurfaceKHR");
    load(vk.surface_support, "vkGetPhysicalDeviceSurfaceSupportKHR");
    load(vk.surface_capabilities, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    load(vk.surface_formats, "vkGetPhysicalDeviceSurfaceFormatsKHR");
    load(vk.present_modes, "vkGetPhysicalDeviceSurfacePresentModesKHR");
    load(vk.create_messenger, "vkCreateDebugUtilsMessengerEXT");
    load(vk.destroy_messenger, "vkDestroyDebugUtilsMessengerEXT");
    load(vk.set_object_name, "vkSetDebugUtilsObjectNameEXT");
    load(vk.begin_label, "vkCmdBeginDebugUtilsLabelEXT");
    load(vk.end_label, "vkCmdEndDebugUtilsLabelEXT");
}

Instance::~Instance() {
    if (messenger_) table_.destroy_messenger(instance_, messenger_, nullptr);
    if (instance_ && !adopted_) table_.destroy_instance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
    return enumerate<VkPhysicalDevice>([&](uint32_t* count, VkPhysicalDevice* list) {
        table_.enumerate_physical_devices(instance_, count, list);
    });
}

void Instance::report(const rhi::Message& message) const {
    if (sink_) {
        sink_(message);
    } else if (is_failure(message)) {
        fmt::print(stderr, "Vulkan: {}: {}\n", message.id, message.text);
    }
}

}  // namespace lumo::backends::vulkan
