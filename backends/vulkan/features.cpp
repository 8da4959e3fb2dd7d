#include "backends/vulkan/features.hpp"

#include <cstring>

namespace lumo::backends::vulkan {

namespace {

template <auto part, auto field>
VkBool32& at(Features& features) {
    return features.*part.*field;
}
template <auto field>
constexpr auto core = at<&Features::core, field>;
template <auto field>
constexpr auto v12 = at<&Features::v12, field>;
template <auto field>
constexpr auto v13 = at<&Features::v13, field>;

using Core = VkPhysicalDeviceFeatures;

constexpr Feature features[] = {
    {"synchronization2", "barriers and submissions", true,
     v13<&VkPhysicalDeviceVulkan13Features::synchronization2>},
    {"dynamicRendering", "raster passes", true, v13<&VkPhysicalDeviceVulkan13Features::dynamicRendering>},
    {"timelineSemaphore", "knowing which submissions are done", true,
     v12<&VkPhysicalDeviceVulkan12Features::timelineSemaphore>},
    {"hostQueryReset", "pass times", true, v12<&VkPhysicalDeviceVulkan12Features::hostQueryReset>},
    {"fragmentStoresAndAtomics", "voxelizing", true, core<&Core::fragmentStoresAndAtomics>},
    {"shaderStorageImageWriteWithoutFormat", "storage images whose format the shader leaves open", true,
     core<&Core::shaderStorageImageWriteWithoutFormat>},
    {"shaderStorageImageExtendedFormats", "storage images of small formats", true,
     core<&Core::shaderStorageImageExtendedFormats>},
    {"independentBlend", "targets of one pass that blend differently", true, core<&Core::independentBlend>},
    {"geometryShader", "programs with a geometry stage", false, core<&Core::geometryShader>},
    {"vertexPipelineStoresAndAtomics", "storage that vertex and geometry stages write", false,
     core<&Core::vertexPipelineStoresAndAtomics>},
    {"depthClamp", "RasterState::depth_clamp", false, core<&Core::depthClamp>},
    {"samplerAnisotropy", "SamplerDesc::max_anisotropy above 1", false, core<&Core::samplerAnisotropy>},
    {"multiDrawIndirect", "several indirect draws by one call instead of by one each", false,
     core<&Core::multiDrawIndirect>},
    {"imageCubeArray", "textures that are arrays of cubes", false, core<&Core::imageCubeArray>},
    {"textureCompressionBC", "textures in BC formats", false, core<&Core::textureCompressionBC>},
};

template <class Structure>
Structure read(const VkBaseInStructure* from) {
    Structure structure;
    std::memcpy(&structure, from, sizeof structure);
    return structure;
}

}  // namespace

std::span<const Feature> used_features() { return features; }

std::vector<std::string> missing_features(const Features& available) {
    Features have = available;
    std::vector<std::string> missing;
    for (const Feature& feature : features)
        if (feature.required && !feature.in(have)) missing.emplace_back(feature.name);
    return missing;
}

Features used_of(const Features& available) {
    Features have = available, used;
    for (const Feature& feature : features) feature.in(used) = feature.in(have);
    return used;
}

Features enabled_in(const VkPhysicalDeviceFeatures2* chain) {
    Features enabled;
    if (!chain) return enabled;
    enabled.core = chain->features;
    auto any = [](VkBool32& bit, VkBool32 other) { bit = bit || other; };
    for (auto* next = static_cast<const VkBaseInStructure*>(chain->pNext); next; next = next->pNext) {
        switch (next->sType) {
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES:
                enabled.v12 = read<VkPhysicalDeviceVulkan12Features>(next);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES:
                enabled.v13 = read<VkPhysicalDeviceVulkan13Features>(next);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES:
                any(enabled.v12.timelineSemaphore,
                    read<VkPhysicalDeviceTimelineSemaphoreFeatures>(next).timelineSemaphore);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES:
                any(enabled.v12.hostQueryReset,
                    read<VkPhysicalDeviceHostQueryResetFeatures>(next).hostQueryReset);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
                any(enabled.v13.synchronization2,
                    read<VkPhysicalDeviceSynchronization2Features>(next).synchronization2);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
                any(enabled.v13.dynamicRendering,
                    read<VkPhysicalDeviceDynamicRenderingFeatures>(next).dynamicRendering);
                break;
            default:
                break;
        }
    }
    return enabled;
}

}  // namespace lumo::backends::vulkan
