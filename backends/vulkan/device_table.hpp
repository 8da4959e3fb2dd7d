// The functions of one device that lumo and its benchmarks call. They are in no global variable: two devices, of
// two loaders, have two tables, and no name of theirs meets the functions of a Vulkan library that a host program
// links.
#pragma once

#include <vulkan/vulkan.h>

namespace lumo::backends::vulkan {

// A macro, because a name has to become both a member and a string.
#define LUMO_VULKAN_DEVICE_FUNCTIONS(X) \
    X(vkAcquireNextImageKHR)            \
    X(vkAllocateCommandBuffers)         \
    X(vkAllocateDescriptorSets)         \
    X(vkAllocateMemory)                 \
    X(vkBeginCommandBuffer)             \
    X(vkBindBufferMemory)               \
    X(vkBindImageMemory)                \
    X(vkCmdBeginRendering)              \
    X(vkCmdBindDescriptorSets)          \
    X(vkCmdBindIndexBuffer)             \
    X(vkCmdBindPipeline)                \
    X(vkCmdBlitImage)                   \
    X(vkCmdClearColorImage)             \
    X(vkCmdClearDepthStencilImage)      \
    X(vkCmdCopyBuffer)                  \
    X(vkCmdCopyBufferToImage)           \
    X(vkCmdCopyImage)                   \
    X(vkCmdCopyImageToBuffer)           \
    X(vkCmdDispatch)                    \
    X(vkCmdDispatchIndirect)            \
    X(vkCmdDraw)                        \
    X(vkCmdDrawIndexed)                 \
    X(vkCmdDrawIndexedIndirect)         \
    X(vkCmdDrawIndirect)                \
    X(vkCmdEndRendering)                \
    X(vkCmdFillBuffer)                  \
    X(vkCmdPipelineBarrier2)            \
    X(vkCmdPushConstants)               \
    X(vkCmdPushDescriptorSetKHR)        \
    X(vkCmdSetScissor)                  \
    X(vkCmdSetViewport)                 \
    X(vkCmdWriteTimestamp2)             \
    X(vkCreateBuffer)                   \
    X(vkCreateCommandPool)              \
    X(vkCreateComputePipelines)         \
    X(vkCreateDescriptorPool)           \
    X(vkCreateDescriptorSetLayout)      \
    X(vkCreateFence)                    \
    X(vkCreateGraphicsPipelines)        \
    X(vkCreateImage)                    \
    X(vkCreateImageView)                \
    X(vkCreatePipelineCache)            \
    X(vkCreatePipelineLayout)           \
    X(vkCreateQueryPool)                \
    X(vkCreateSampler)                  \
    X(vkCreateSemaphore)                \
    X(vkCreateShaderModule)             \
    X(vkCreateSwapchainKHR)             \
    X(vkDestroyBuffer)                  \
    X(vkDestroyCommandPool)             \
    X(vkDestroyDescriptorPool)          \
    X(vkDestroyDescriptorSetLayout)     \
    X(vkDestroyDevice)                  \
    X(vkDestroyFence)                   \
    X(vkDestroyImage)                   \
    X(vkDestroyImageView)               \
    X(vkDestroyPipeline)                \
    X(vkDestroyPipelineCache)           \
    X(vkDestroyPipelineLayout)          \
    X(vkDestroyQueryPool)               \
    X(vkDestroySampler)                 \
    X(vkDestroySemaphore)               \
    X(vkDestroyShaderModule)            \
    X(vkDestroySwapchainKHR)            \
    X(vkDeviceWaitIdle)                 \
    X(vkEndCommandBuffer)               \
    X(vkFreeMemory)                     \
    X(vkGetBufferMemoryRequirements2)   \
    X(vkGetDeviceQueue)                 \
    X(vkGetImageMemoryRequirements2)    \
    X(vkGetPipelineCacheData)           \
    X(vkGetQueryPoolResults)            \
    X(vkGetSemaphoreCounterValue)       \
    X(vkGetSwapchainImagesKHR)          \
    X(vkMapMemory)                      \
    X(vkQueuePresentKHR)                \
    X(vkQueueSubmit2)                   \
    X(vkQueueWaitIdle)                  \
    X(vkResetCommandPool)               \
    X(vkResetDescriptorPool)            \
    X(vkResetFences)                    \
    X(vkResetQueryPool)                 \
    X(vkSignalSemaphore)                \
    X(vkUpdateDescriptorSets)           \
    X(vkWaitForFences)                  \
    X(vkWaitSemaphores)

#define LUMO_MEMBER(function) PFN_##function function = nullptr;
struct DeviceTable {
    LUMO_VULKAN_DEVICE_FUNCTIONS(LUMO_MEMBER)
};
#undef LUMO_MEMBER

/// The device's own functions, past the loader's dispatch; null for those of extensions that are not enabled.
DeviceTable load_device_table(PFN_vkGetDeviceProcAddr get, VkDevice device);

}  // namespace lumo::backends::vulkan
