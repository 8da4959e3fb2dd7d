#include "tests/adopt/vulkan_host.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string_view>

#include "tests/support/required.hpp"

namespace lumo::testing_support {
namespace {

void must_succeed(VkResult result, const char* call) {
    if (result != VK_SUCCESS)
        throw std::runtime_error(std::string(call) + " returned " + std::to_string(int(result)));
}

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data,
                                            void* messages) {
    const std::string id = data->pMessageIdName ? data->pMessageIdName : "";
    // The loader complains about drivers that are installed badly and not used.
    if (id != "Loader Message")
        static_cast<std::vector<std::string>*>(messages)->push_back(id + ": " + data->pMessage);
    return VK_FALSE;
}

template <class F>
F function(VkInstance instance, const char* name) {
    return reinterpret_cast<F>(vkGetInstanceProcAddr(instance, name));
}

std::unique_ptr<VulkanHost> none() {
    if (apis_required()) ADD_FAILURE() << "there is no Vulkan device";
    return nullptr;
}

constexpr VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};

}  // namespace

HostFeatures HostFeatures::required() {
    HostFeatures features;
    features.core.fragmentStoresAndAtomics = VK_TRUE;
    features.core.shaderStorageImageWriteWithoutFormat = VK_TRUE;
    features.core.shaderStorageImageExtendedFormats = VK_TRUE;
    features.core.independentBlend = VK_TRUE;
    features.v12.timelineSemaphore = VK_TRUE;
    features.v12.hostQueryReset = VK_TRUE;
    features.v13.synchronization2 = VK_TRUE;
    features.v13.dynamicRendering = VK_TRUE;
    return features;
}

VkPhysicalDeviceFeatures2 HostFeatures::chain() {
    v12.pNext = &v13;
    return {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12, .features = core};
}

std::unique_ptr<VulkanHost> VulkanHost::open(const Asked& asked) {
    std::unique_ptr<VulkanHost> host(new VulkanHost);
    host->features_ = asked.features;
    host->chain_ = host->features_.chain();
    host->extensions_ = asked.extensions;

    VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = keep_message,
        .pUserData = host->messages_.get()};
    const auto synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                             .pNext = &messenger,
                                             .enabledValidationFeatureCount = 1,
                                             .pEnabledValidationFeatures = &synchronization};
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .apiVersion = VK_API_VERSION_1_3};
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* instance_extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    const uint32_t debug = asked.debug_utils ? 1 : 0;
    const VkInstanceCreateInfo instance_info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                             .pNext = debug ? &validation : nullptr,
                                             .pApplicationInfo = &application,
                                             .enabledLayerCount = debug,
                                             .ppEnabledLayerNames = &layer,
                                             .enabledExtensionCount = debug,
                                             .ppEnabledExtensionNames = instance_extensions};
    const VkResult made = vkCreateInstance(&instance_info, nullptr, &host->instance_);
    if (made == VK_ERROR_INCOMPATIBLE_DRIVER) return none();
    must_succeed(made, "vkCreateInstance");
    if (debug) {
        auto create =
            function<PFN_vkCreateDebugUtilsMessengerEXT>(host->instance_, "vkCreateDebugUtilsMessengerEXT");
        must_succeed(create(host->instance_, &messenger, nullptr, &host->messenger_), "the messenger");
    }

    uint32_t count = 1;
    vkEnumeratePhysicalDevices(host->instance_, &count, &host->physical_);
    if (count == 0) return none();
    std::vector<VkQueueFamilyProperties> families(16);
    count = uint32_t(families.size());
    vkGetPhysicalDeviceQueueFamilyProperties(host->physical_, &count, families.data());
    constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while (host->family_ + 1 < count && (families[host->family_].queueFlags & both) != both) ++host->family_;

    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = host->family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    const VkDeviceCreateInfo device_info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                         .pNext = &host->chain_,
                                         .queueCreateInfoCount = 1,
                                         .pQueueCreateInfos = &queue,
                                         .enabledExtensionCount = uint32_t(host->extensions_.size()),
                                         .ppEnabledExtensionNames = host->extensions_.data()};
    must_succeed(vkCreateDevice(host->physical_, &device_info, nullptr, &host->device_), "vkCreateDevice");
    vkGetDeviceQueue(host->device_, host->family_, 0, &host->queue_);
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .queueFamilyIndex = host->family_};
    must_succeed(vkCreateCommandPool(host->device_, &pool, nullptr, &host->pool_), "vkCreateCommandPool");
    return host;
}

VulkanHost::~VulkanHost() {
    if (device_) {
        vkDeviceWaitIdle(device_);
        for (VkSemaphore semaphore : semaphores_) vkDestroySemaphore(device_, semaphore, nullptr);
        for (VkImage image : images_) vkDestroyImage(device_, image, nullptr);
        for (VkBuffer buffer : buffers_) vkDestroyBuffer(device_, buffer, nullptr);
        for (VkDeviceMemory memory : memories_) vkFreeMemory(device_, memory, nullptr);
        vkDestroyCommandPool(device_, pool_, nullptr);
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
            instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

backends::vulkan::HostDevice VulkanHost::described() const {
    return {.get_instance_proc_addr = vkGetInstanceProcAddr,
            .instance = instance_,
            .api_version = VK_API_VERSION_1_3,
            .physical_device = physical_,
            .device = device_,
            .queue = queue_,
            .queue_family = family_,
            .features = &chain_,
            .extensions = extensions_};
}

std::string VulkanHost::device_name() const {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical_, &properties);
    return properties.deviceName;
}

uint32_t VulkanHost::memory_type(uint32_t allowed, VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (uint32_t type = 0; type < memory.memoryTypeCount; ++type)
        if ((allowed >> type & 1) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted) return type;
    throw std::runtime_error("no memory of the wanted type");
}

VkImage VulkanHost::image(VkFormat format, uint32_t side, VkImageUsageFlags usage, uint32_t mips) {
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = format,
                                 .extent = {side, side, 1},
                                 .mipLevels = mips,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .usage = usage};
    VkImage& image = images_.emplace_back();
    must_succeed(vkCreateImage(device_, &info, nullptr, &image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_, image, &needs);
    const VkMemoryAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .allocationSize = needs.size,
                                        .memoryTypeIndex = memory_type(needs.memoryTypeBits, 0)};
    must_succeed(vkAllocateMemory(device_, &allocate, nullptr, &memories_.emplace_back()),
                 "vkAllocateMemory");
    must_succeed(vkBindImageMemory(device_, image, memories_.back(), 0), "vkBindImageMemory");
    return image;
}

void VulkanHost::destroy(VkImage image) {
    std::erase(images_, image);
    vkDestroyImage(device_, image, nullptr);
}

VulkanHost::Buffer VulkanHost::buffer(uint64_t size, VkBufferUsageFlags usage) {
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    VkBuffer buffer = VK_NULL_HANDLE;
    must_succeed(vkCreateBuffer(device_, &info, nullptr, &buffer), "vkCreateBuffer");
    buffers_.push_back(buffer);
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, buffer, &needs);
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                                 VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)};
    must_succeed(vkAllocateMemory(device_, &allocate, nullptr, &memories_.emplace_back()),
                 "vkAllocateMemory");
    must_succeed(vkBindBufferMemory(device_, buffer, memories_.back(), 0), "vkBindBufferMemory");
    void* mapped = nullptr;
    must_succeed(vkMapMemory(device_, memories_.back(), 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    return {buffer, mapped};
}

VkSemaphore VulkanHost::semaphore(bool timeline) {
    const VkSemaphoreTypeCreateInfo type{
        .sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
        .semaphoreType = timeline ? VK_SEMAPHORE_TYPE_TIMELINE : VK_SEMAPHORE_TYPE_BINARY};
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    must_succeed(vkCreateSemaphore(device_, &info, nullptr, &semaphores_.emplace_back()),
                 "vkCreateSemaphore");
    return semaphores_.back();
}

void VulkanHost::submit(const std::function<void(VkCommandBuffer)>& record, VkSemaphore wait,
                        VkSemaphore signal) {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool_,
                                               .commandBufferCount = 1};
    must_succeed(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    must_succeed(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    must_succeed(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkPipelineStageFlags everything = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .waitSemaphoreCount = wait ? 1u : 0u,
                            .pWaitSemaphores = &wait,
                            .pWaitDstStageMask = &everything,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &commands,
                            .signalSemaphoreCount = signal ? 1u : 0u,
                            .pSignalSemaphores = &signal};
    must_succeed(vkQueueSubmit(queue_, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit");
}

std::vector<std::byte> VulkanHost::download(VkImage image, VkImageLayout layout, uint32_t side,
                                            uint32_t texel_bytes) {
    const uint64_t size = uint64_t(side) * side * texel_bytes;
    const auto [buffer, mapped] = this->buffer(size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    submit([&, target = buffer](VkCommandBuffer commands) {
        const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                       .imageExtent = {side, side, 1}};
        vkCmdCopyImageToBuffer(commands, image, layout, target, 1, &region);
        show_to_cpu(commands);
    });
    wait_idle();
    std::vector<std::byte> texels(size);
    std::memcpy(texels.data(), mapped, size);
    return texels;
}

void show_to_cpu(VkCommandBuffer commands) {
    const VkMemoryBarrier visible{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &visible, 0, nullptr, 0, nullptr);
}

void transition(VkCommandBuffer commands, VkImage image, VkImageLayout before, VkImageLayout after) {
    const VkImageMemoryBarrier barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = before,
        .newLayout = after,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = whole};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0,
                         0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace lumo::testing_support
