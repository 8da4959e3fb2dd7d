#include "backends/vulkan/gpu.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "backends/vulkan/candidate.hpp"
#include "backends/vulkan/convert.hpp"

namespace lumo::backends::vulkan {

namespace {

using rhi::FormatCaps;
using rhi::Timing;

/// That the host said all that cannot be asked.
Result<void> check_host(const HostDevice& host, const rhi::DeviceDesc& desc) {
    auto missing = [](const char* member) {
        return fail(ErrorKind::invalid_argument, "HostDevice", fmt::format("{} is not set", member),
                    "give it as backends/vulkan/adopt.hpp says");
    };
    if (!host.get_instance_proc_addr) return missing("get_instance_proc_addr");
    if (!host.instance) return missing("instance");
    if (!host.physical_device) return missing("physical_device");
    if (!host.device) return missing("device");
    if (!host.queue) return missing("queue");
    if (desc.validation) {
        return fail(ErrorKind::invalid_argument, "DeviceDesc", "validation is asked for on a host's device",
                    "switch the layers on with the host's instance");
    }
    return {};
}

std::string words(VkResult result) {
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "VK_ERROR_OUT_OF_HOST_MEMORY";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
        case VK_ERROR_DEVICE_LOST:
            return "VK_ERROR_DEVICE_LOST";
        default:
            return fmt::format("VkResult {}", int(result));
    }
}

}  // namespace

tl::unexpected<Error> fail(VkResult result, std::string subject, std::string_view call) {
    std::string message = fmt::format("{} returned {}", call, words(result));
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
    gpu->take(*chosen, desc);
    gpu->info_.validation = desc.validation;
    gpu->info_.window = gpu->surface_ != VK_NULL_HANDLE;

    gpu->features_.v12.pNext = &gpu->features_.v13;
    VkPhysicalDeviceFeatures2 enabled{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                      .pNext = &gpu->features_.v12,
                                      .features = gpu->features_.core};
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
    gpu->table_ = load_device_table(gpu->instance_->vk().get_device_proc_addr, gpu->device_);
    gpu->table_.vkGetDeviceQueue(gpu->device_, gpu->queue_family_, 0, &gpu->queue_);
    gpu->query_formats();
    return gpu;
}

Result<std::unique_ptr<Gpu>> Gpu::adopt(const HostDevice& host, const rhi::DeviceDesc& desc) {
    if (auto complete = check_host(host, desc); !complete) return tl::unexpected(complete.error());
    auto instance = Instance::adopt(host.get_instance_proc_addr, host.instance, desc.sink);
    if (!instance) return tl::unexpected(instance.error());

    const Usable usable{{host.extensions.begin(), host.extensions.end()}, enabled_in(host.features)};
    Candidate found = look_at(**instance, host.physical_device, usable, host.queue_family);
    if (host.api_version < VK_API_VERSION_1_3) {
        found.lacks.push_back(fmt::format("an instance of Vulkan 1.3 (it was made for {}.{})",
                                          VK_API_VERSION_MAJOR(host.api_version),
                                          VK_API_VERSION_MINOR(host.api_version)));
    }
    if (!has_name(found, desc.name)) {
        return fail(ErrorKind::no_device, desc.name, fmt::format("the host's device is \"{}\"", found.name()),
                    "ask for no name, or adopt another device");
    }
    if (!found.lacks.empty()) {
        return fail(ErrorKind::unsupported, std::string(found.name()),
                    fmt::format("the host's device was made without {}", fmt::join(found.lacks, ", ")),
                    "enable it where the host makes its device; docs/porting.md lists all");
    }
    std::unique_ptr<Gpu> gpu(new Gpu);
    gpu->adopted_ = true;
    gpu->instance_ = std::move(*instance);
    gpu->take(found, desc);
    gpu->device_ = host.device;
    gpu->queue_ = host.queue;
    gpu->table_ = load_device_table(gpu->instance_->vk().get_device_proc_addr, gpu->device_);
    gpu->query_formats();
    return gpu;
}

Gpu::~Gpu() {
    if (device_ && !adopted_) table_.vkDestroyDevice(device_, nullptr);
    if (surface_) instance_->vk().destroy_surface(instance_->handle(), surface_, nullptr);
}

void Gpu::take(const Candidate& candidate, const rhi::DeviceDesc& desc) {
    physical_ = candidate.device;
    properties_ = candidate.properties;
    features_ = used_of(candidate.features);
    info_ = describe(candidate);
    if (desc.timing != Timing::automatic) info_.timing = desc.timing;
    queue_family_ = *candidate.queue_family;
    timestamp_bits_ = candidate.timestamp_bits;
    push_descriptors_ = candidate.push_descriptors;
    budget_ = candidate.budget;
}

void Gpu::query_formats() {
    for (int i = 1; i < rhi::format_count; ++i) {
        auto format = rhi::Format(i);
        VkFormatProperties2 properties{.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2};
        instance_->vk().format_properties(physical_, to_vk(format), &properties);
        VkFormatFeatureFlags has = properties.formatProperties.optimalTilingFeatures;
        // What a host did not enable is not there, whatever the driver could do.
        if (rhi::format_info(format).block_side > 1 && !features_.core.textureCompressionBC) has = 0;
        FormatCaps caps = FormatCaps::none;
        auto add = [&](VkFormatFeatureFlags bits, FormatCaps cap) {
            if (has & bits) caps |= cap;
        };
        constexpr VkFormatFeatureFlags attachment =
            VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT;
        add(VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, FormatCaps::sampled);
        add(VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT, FormatCaps::linear_filter);
        add(VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT, FormatCaps::storage);
        // Of floats, atomics are an extension's, and OpenGL has none.
        if (rhi::format_info(format).kind != rhi::FormatKind::floating)
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
