#include "backends/vulkan/candidate.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lumo::backends::vulkan {

namespace {

using rhi::Timing;

Usable all_of(const Instance& instance, VkPhysicalDevice device) {
    const auto& vk = instance.vk();
    Usable all;
    for (const auto& extension :
         enumerate<VkExtensionProperties>([&](uint32_t*count, VkExtensionProperties*list) {
             vk.device_extensions(device, nullptr, count, list);
         }))
        all.extensions.emplace_back(extension.extensionName);
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &all.features.v12};
    all.features.v12.pNext = &all.features.v13;
    vk.features(device, &features);
    all.features.core = features.features;
    all.features.v12.pNext = nullptr;
    return all;
}

bool has_extension(const Usable& usable, std::string_view name) {
    return std::find(usable.extensions.begin(), usable.extensions.end(), name) != usable.extensions.end();
}

/// All but its queue.
Candidate look_at(const Instance& instance, VkPhysicalDevice device, const Usable& usable) {
    Candidate found{.device = device, .features = usable.features};
    found.push_descriptors = has_extension(usable, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    found.budget = has_extension(usable, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);

    VkPhysicalDevicePushDescriptorPropertiesKHR push{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR};
    found.driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                    .pNext = found.push_descriptors ? &push : nullptr};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &found.driver};
    instance.vk().properties(device, &properties);
    found.driver.pNext = nullptr;
    found.properties = properties.properties;
    found.push_descriptors = found.push_descriptors && push.maxPushDescriptors >= 32;

    const uint32_t version = found.properties.apiVersion;
    if (version < VK_API_VERSION_1_3) {
        found.lacks.push_back(fmt::format("Vulkan 1.3 (it has {}.{})", VK_API_VERSION_MAJOR(version),
                                          VK_API_VERSION_MINOR(version)));
    }
    for (std::string& name : missing_features(usable.features)) found.lacks.push_back(std::move(name));
    return found;
}

std::vector<VkQueueFamilyProperties> queue_families(const Instance& instance, VkPhysicalDevice device) {
    return enumerate<VkQueueFamilyProperties>([&](uint32_t* count, VkQueueFamilyProperties* list) {
        instance.vk().queue_families(device, count, list);
    });
}

bool draws_and_computes(const VkQueueFamilyProperties& family) {
    constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    return (family.queueFlags & both) == both;
}

/// The higher, the more likely it is fast.
int rank(VkPhysicalDeviceType type) {
    constexpr int ranks[] = {0, 3, 4, 2, 1};  // other, integrated, discrete, virtual, CPU
    return size_t(type) < std::size(ranks) ? ranks[type] : 0;
}

}  // namespace

Candidate look_at(const Instance& instance, VkPhysicalDevice device, VkSurfaceKHR surface) {
    const Usable all = all_of(instance, device);
    Candidate found = look_at(instance, device, all);
    const auto families = queue_families(instance, device);
    auto family = std::find_if(families.begin(), families.end(), [&](const VkQueueFamilyProperties& f) {
        VkBool32 presents = VK_TRUE;
        if (surface)
            instance.vk().surface_support(device, uint32_t(&f - families.data()), surface, &presents);
        return draws_and_computes(f) && presents;
    });
    if (surface && !has_extension(all, VK_KHR_SWAPCHAIN_EXTENSION_NAME))
        found.lacks.emplace_back("swapchains");
    if (family == families.end()) {
        found.lacks.emplace_back(surface ? "a queue for graphics, compute and presenting to this window"
                                         : "a queue for both graphics and compute");
    } else {
        found.queue_family = uint32_t(family - families.begin());
        found.timestamp_bits = family->timestampValidBits;
    }
    return found;
}

Candidate look_at(const Instance& instance, VkPhysicalDevice device, const Usable& usable,
                  uint32_t queue_family) {
    Candidate found = look_at(instance, device, usable);
    const auto families = queue_families(instance, device);
    if (queue_family >= families.size() || !draws_and_computes(families[queue_family])) {
        found.lacks.push_back(
            fmt::format("a queue for both graphics and compute (family {} is none)", queue_family));
    } else {
        found.queue_family = queue_family;
        found.timestamp_bits = families[queue_family].timestampValidBits;
    }
    return found;
}

bool has_name(const Candidate& candidate, std::string_view part) {
    const std::string_view name = candidate.name();
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
    std::erase_if(candidates, [&](const Candidate& c) { return !has_name(c, name); });
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
        .geometry_shader = candidate.features.core.geometryShader == VK_TRUE,
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
    out.max_anisotropy = candidate.features.core.samplerAnisotropy ? limits.maxSamplerAnisotropy : 1;
    out.max_samples =
        std::bit_floor(limits.framebufferColorSampleCounts & limits.framebufferDepthSampleCounts);
    return info;
}

}  // namespace lumo::backends::vulkan
