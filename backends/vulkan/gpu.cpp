#include "backends/vulkan/gpu.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>

#include "backends/vulkan/convert.hpp"

namespace lumo::backends::vulkan {

namespace {

using rhi::FormatCaps;
using rhi::Timing;

/// The features that lumo uses, and whether it runs without them. Beyond these it needs only what every
/// Vulkan 1.3 device has: dynamic rendering, synchronization2, timeline semaphores, host query reset.
struct Feature {
    const char* name;
    VkBool32 VkPhysicalDeviceFeatures::*field;
    bool required;
};
constexpr Feature features[] = {
    {"fragmentStoresAndAtomics", &VkPhysicalDeviceFeatures::fragmentStoresAndAtomics, true},
    {"shaderStorageImageWriteWithoutFormat", &VkPhysicalDeviceFeatures::shaderStorageImageWriteWithoutFormat,
     true},
    {"shaderStorageImageExtendedFormats", &VkPhysicalDeviceFeatures::shaderStorageImageExtendedFormats, true},
    {"independentBlend", &VkPhysicalDeviceFeatures::independentBlend, true},
    {"geometryShader", &VkPhysicalDeviceFeatures::geometryShader, false},
    {"vertexPipelineStoresAndAtomics", &VkPhysicalDeviceFeatures::vertexPipelineStoresAndAtomics, false},
    {"depthClamp", &VkPhysicalDeviceFeatures::depthClamp, false},
    {"samplerAnisotropy", &VkPhysicalDeviceFeatures::samplerAnisotropy, false},
    {"multiDrawIndirect", &VkPhysicalDeviceFeatures::multiDrawIndirect, false},
    {"imageCubeArray", &VkPhysicalDeviceFeatures::imageCubeArray, false},
    {"textureCompressionBC", &VkPhysicalDeviceFeatures::textureCompressionBC, false},
};

/// What is known of a physical device before it is opened.
struct Candidate {
    VkPhysicalDevice device;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceDriverProperties driver;
    VkPhysicalDeviceFeatures features;
    uint32_t max_push_descriptors = 0;
    bool push_descriptors = false;
    bool budget = false;
    std::optional<uint32_t> queue_family;
    uint32_t timestamp_bits = 0;
    std::vector<std::string> lacks;

    std::string_view name() const { return properties.deviceName; }
};

/// With a surface, as a device that presents to it.
Candidate look_at(const Instance& instance, VkPhysicalDevice device, VkSurfaceKHR surface = VK_NULL_HANDLE) {
    const auto& vk = instance.vk();
    Candidate found{.device = device};

    auto extensions = enumerate<VkExtensionProperties>([&](uint32_t* count, VkExtensionProperties* list) {
        vk.device_extensions(device, nullptr, count, list);
    });
    auto has_extension = [&](std::string_view name) {
        return std::any_of(extensions.begin(), extensions.end(),
                           [&](const VkExtensionProperties& e) { return name == e.extensionName; });
    };
    found.push_descriptors = has_extension(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    found.budget = has_extension(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);

    VkPhysicalDevicePushDescriptorPropertiesKHR push{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR};
    found.driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                    .pNext = found.push_descriptors ? &push : nullptr};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &found.driver};
    vk.properties(device, &properties);
    found.driver.pNext = nullptr;
    found.properties = properties.properties;
    found.push_descriptors = found.push_descriptors && push.maxPushDescriptors >= 32;

    VkPhysicalDeviceFeatures2 available{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    vk.features(device, &available);
    found.features = available.features;

    uint32_t version = found.properties.apiVersion;
    if (version < VK_API_VERSION_1_3) {
        found.lacks.push_back(fmt::format("Vulkan 1.3 (it has {}.{})", VK_API_VERSION_MAJOR(version),
                                          VK_API_VERSION_MINOR(version)));
    }
    for (const auto& feature : features) {
        if (feature.required && !(found.features.*feature.field)) found.lacks.emplace_back(feature.name);
    }
    auto families = enumerate<VkQueueFamilyProperties>(
        [&](uint32_t* count, VkQueueFamilyProperties* list) { vk.queue_families(device, count, list); });
    constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    auto family = std::find_if(families.begin(), families.end(), [&](const VkQueueFamilyProperties& f) {
        VkBool32 presents = VK_TRUE;
        if (surface) vk.surface_support(device, uint32_t(&f - families.data()), surface, &presents);
        return (f.queueFlags & both) == both && presents;
    });
    if (surface && !has_extension(VK_KHR_SWAPCHAIN_EXTENSION_NAME)) found.lacks.emplace_back("swapchains");
    if (family == families.end()) {
        found.lacks.emplace_back(surface ? "a queue for graphics, compute and presenting to this window"
                                         : "a queue for both graphics and compute");
    } else {
        found.queue_family = uint32_t(family - families.begin());
        found.timestamp_bits = family->timestampValidBits;
    }
    return found;
}

/// The higher, the more likely it is fast.
int rank(VkPhysicalDeviceType type) {
    constexpr int ranks[] = {0, 3, 4, 2, 1};  // other, integrated, discrete, virtual, CPU
    return size_t(type) < std::size(ranks) ? ranks[type] : 0;
}

/// `part` in `name`, without case.
bool names(std::string_view name, std::string_view part) {
    return std::search(name.begin(), name.end(), part.begin(), part.end(), [](char a, char b) {
               return std::tolower(uint8_t(a)) == std::tolower(uint8_t(b));
           }) != name.end();
}

Result<Candidate> choose(const Instance& instance, std::string_view name, VkSurfaceKHR surface) {
    std::vector<Candidate> candidates;
    for (VkPhysicalDevice device : instance.physical_devices())
        candidates.push_back(look_at(instance, device, surface));
    if (candidates.empty()) {
        return fail(ErrorKind::no_device, "Vulkan", "no device was found",
                    "install a Vulkan driver, such as the package mesa-vulkan-drivers, or use OpenGL");
    }
    std::string list;
    for (const auto& candidate : candidates)
        list += (list.empty() ? "" : ", ") + std::string(candidate.name());
    std::erase_if(candidates, [&](const Candidate& c) { return !names(c.name(), name); });
    if (candidates.empty()) {
        return fail(ErrorKind::no_device, std::string(name), "no Vulkan device has this name",
                    "found: " + list);
    }
    auto best = std::max_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        auto key = [](const Candidate& c) {
            return std::pair(c.lacks.empty(), rank(c.properties.deviceType));
        };
        return key(a) < key(b);
    });
    if (!best->lacks.empty()) {
        return fail(ErrorKind::unsupported, std::string(best->name()),
                    fmt::format("the device lacks {}", fmt::join(best->lacks, ", ")),
                    "update its driver, or name another device; found: " + list);
    }
    return *best;
}

rhi::DeviceInfo describe(const Candidate& candidate) {
    const auto& properties = candidate.properties;
    const auto& limits = properties.limits;
    bool software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    rhi::DeviceInfo info{
        .api = rhi::Api::vulkan,
        .name = properties.deviceName,
        .driver = fmt::format("{} {}", candidate.driver.driverName, candidate.driver.driverInfo),
        .api_version = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(properties.apiVersion),
                                   VK_API_VERSION_MINOR(properties.apiVersion),
                                   VK_API_VERSION_PATCH(properties.apiVersion)),
        .software = software,
        .geometry_shader = candidate.features.geometryShader == VK_TRUE,
        .timing = software ? Timing::serialised : Timing::overlapped,
    };
    auto& out = info.limits;
    std::copy_n(limits.maxComputeWorkGroupCount, 3, out.max_groups);
    std::copy_n(limits.maxComputeWorkGroupSize, 3, out.max_group_size);
    out.max_group_invocations = limits.maxComputeWorkGroupInvocations;
    out.max_shared_memory = limits.maxComputeSharedMemorySize;
    out.max_texture_side_2d = limits.maxImageDimension2D;
    out.max_texture_side_3d = limits.maxImageDimension3D;
    out.max_texture_layers = limits.maxImageArrayLayers;
    out.max_storage_bytes = limits.maxStorageBufferRange;
    out.max_uniform_bytes = limits.maxUniformBufferRange;
    out.storage_alignment = uint32_t(limits.minStorageBufferOffsetAlignment);
    out.uniform_alignment = uint32_t(limits.minUniformBufferOffsetAlignment);
    out.max_color_targets = limits.maxColorAttachments;
    out.max_anisotropy = candidate.features.samplerAnisotropy ? limits.maxSamplerAnisotropy : 1;
    out.max_samples =
        std::bit_floor(limits.framebufferColorSampleCounts & limits.framebufferDepthSampleCounts);
    return info;
}

}  // namespace

tl::unexpected<Error> fail(VkResult result, std::string subject, std::string_view call) {
    std::string message = fmt::format("{} returned VkResult {}", call, int(result));
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        case VK_ERROR_TOO_MANY_OBJECTS:
            return fail(ErrorKind::out_of_memory, std::move(subject), std::move(message));
        case VK_ERROR_DEVICE_LOST:
            return fail(ErrorKind::device_lost, std::move(subject), std::move(message),
                        "make the device again; if it is lost again, look at the driver's log");
        default:
            return fail(ErrorKind::unsupported, std::move(subject), std::move(message));
    }
}

std::vector<rhi::DeviceInfo> list_devices(const Instance& instance) {
    std::vector<rhi::DeviceInfo> list;
    for (VkPhysicalDevice device : instance.physical_devices()) {
        list.push_back(describe(look_at(instance, device)));
    }
    return list;
}

Result<std::unique_ptr<Gpu>> Gpu::create(const rhi::DeviceDesc& desc, std::shared_ptr<const Surface> window) {
    using Extensions = std::span<const char* const>;
    auto instance = Instance::create(desc.validation, desc.sink,
                                     window ? Extensions(window->instance_extensions) : Extensions());
    if (!instance) return tl::unexpected(instance.error());
    std::unique_ptr<Gpu> gpu(new Gpu);
    gpu->window_ = std::move(window);
    gpu->instance_ = std::move(*instance);
    if (gpu->window_) {
        auto surface = gpu->window_->create_vulkan_surface(gpu->instance_->handle());
        if (!surface) return tl::unexpected(surface.error());
        gpu->surface_ = reinterpret_cast<VkSurfaceKHR>(*surface);
    }
    auto chosen = choose(*gpu->instance_, desc.name, gpu->surface_);
    if (!chosen) return tl::unexpected(chosen.error());
    gpu->physical_ = chosen->device;
    gpu->properties_ = chosen->properties;
    gpu->info_ = describe(*chosen);
    gpu->info_.validation = desc.validation;
    gpu->info_.window = gpu->surface_ != VK_NULL_HANDLE;
    if (desc.timing != Timing::automatic) gpu->info_.timing = desc.timing;
    gpu->queue_family_ = *chosen->queue_family;
    gpu->timestamp_bits_ = chosen->timestamp_bits;
    gpu->push_descriptors_ = chosen->push_descriptors;
    gpu->multi_draw_indirect_ = chosen->features.multiDrawIndirect;
    gpu->budget_ = chosen->budget;

    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                         .synchronization2 = VK_TRUE,
                                         .dynamicRendering = VK_TRUE,
                                         .maintenance4 = VK_TRUE};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                         .pNext = &v13,
                                         .hostQueryReset = VK_TRUE,
                                         .timelineSemaphore = VK_TRUE};
    VkPhysicalDeviceFeatures2 enabled{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
    for (const auto& feature : features) enabled.features.*feature.field = chosen->features.*feature.field;

    std::vector<const char*> extensions;
    if (gpu->push_descriptors_) extensions.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    if (gpu->budget_) extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    if (gpu->surface_) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    float priority = 1;
    VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                  .queueFamilyIndex = gpu->queue_family_,
                                  .queueCount = 1,
                                  .pQueuePriorities = &priority};
    VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                            .pNext = &enabled,
                            .queueCreateInfoCount = 1,
                            .pQueueCreateInfos = &queue,
                            .enabledExtensionCount = uint32_t(extensions.size()),
                            .ppEnabledExtensionNames = extensions.data()};
    VkResult result = gpu->instance_->vk().create_device(gpu->physical_, &info, nullptr, &gpu->device_);
    if (result != VK_SUCCESS) return fail(result, gpu->info_.name, "vkCreateDevice");
    gpu->instance_->load(gpu->table_, gpu->device_);
    gpu->table_.vkGetDeviceQueue(gpu->device_, gpu->queue_family_, 0, &gpu->queue_);
    gpu->query_formats();
    return gpu;
}

Gpu::~Gpu() {
    if (device_) table_.vkDestroyDevice(device_, nullptr);
    if (surface_) instance_->vk().destroy_surface(instance_->handle(), surface_, nullptr);
}

void Gpu::query_formats() {
    for (int i = 1; i < rhi::format_count; ++i) {
        auto format = rhi::Format(i);
        VkFormatProperties2 properties{.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2};
        instance_->vk().format_properties(physical_, to_vk(format), &properties);
        VkFormatFeatureFlags has = properties.formatProperties.optimalTilingFeatures;
        FormatCaps caps = FormatCaps::none;
        auto add = [&](VkFormatFeatureFlags bits, FormatCaps cap) {
            if (has & bits) caps |= cap;
        };
        constexpr VkFormatFeatureFlags attachment =
            VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT;
        add(VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, FormatCaps::sampled);
        add(VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT, FormatCaps::linear_filter);
        add(VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT, FormatCaps::storage);
        add(VK_FORMAT_FEATURE_STORAGE_IMAGE_ATOMIC_BIT, FormatCaps::storage_atomic);
        add(attachment, FormatCaps::attachment);
        add(VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT, FormatCaps::blend);
        if (has & attachment) {
            VkPhysicalDeviceImageFormatInfo2 image{
                .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_IMAGE_FORMAT_INFO_2,
                .format = to_vk(format),
                .type = VK_IMAGE_TYPE_2D,
                .tiling = VK_IMAGE_TILING_OPTIMAL,
                .usage = VkImageUsageFlags(aspect_of(format) == VK_IMAGE_ASPECT_DEPTH_BIT
                                               ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                               : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
            VkImageFormatProperties2 out{.sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_PROPERTIES_2};
            VkResult result = instance_->vk().image_format_properties(physical_, &image, &out);
            if (result == VK_SUCCESS && out.imageFormatProperties.sampleCounts > 1) {
                caps |= FormatCaps::multisample;
            }
        }
        format_caps_[size_t(i)] = caps;
    }
}

rhi::MemoryBudget Gpu::memory_budget() const {
    if (!budget_) return {};
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
    VkPhysicalDeviceMemoryProperties2 memory{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
                                             .pNext = &budget};
    instance_->vk().memory_properties(physical_, &memory);
    rhi::MemoryBudget sum;
    for (uint32_t i = 0; i < memory.memoryProperties.memoryHeapCount; ++i) {
        if (!(memory.memoryProperties.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)) continue;
        sum.used_bytes += budget.heapUsage[i];
        sum.budget_bytes += budget.heapBudget[i];
    }
    return sum;
}

void Gpu::set_name(VkObjectType type, uint64_t object, std::string_view name) const {
    if (!instance_->vk().set_object_name || name.empty()) return;
    std::string text(name);
    VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                       .objectType = type,
                                       .objectHandle = object,
                                       .pObjectName = text.c_str()};
    instance_->vk().set_object_name(device_, &info);
}

}  // namespace lumo::backends::vulkan
