// What of a Vulkan device is used beyond what every 1.3 device does without being asked.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace lumo::backends::vulkan {

/// The features of a device: those that it has, or those that are enabled.
struct Features {
    VkPhysicalDeviceFeatures core{};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
};

/// A feature that lumo uses.
struct Feature {
    const char* name;     ///< as Vulkan spells it
    const char* purpose;  ///< what it is for
    bool required;        ///< else lumo does without, or refuses what needs it
    VkBool32& (*in)(Features&);
};

std::span<const Feature> used_features();
/// Names of the required features that are missing.
std::vector<std::string> missing_features(const Features& features);
/// The features that lumo uses, out of these.
Features used_of(const Features& features);
/// What a device was made with: a VkPhysicalDeviceFeatures2 with structures of Vulkan 1.2 and 1.3, or of single
/// features. Null has none.
Features enabled_in(const VkPhysicalDeviceFeatures2* chain);

}  // namespace lumo::backends::vulkan
