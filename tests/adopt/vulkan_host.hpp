// A Vulkan program of another making, for tests: it links the Vulkan library itself, makes its own instance with the
// validation layers, its own device and images, and hands them to lumo.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>
#include <vulkan/vulkan.h>

#include "backends/vulkan/adopt.hpp"

namespace lumo::testing_support {

struct HostFeatures {
    VkPhysicalDeviceFeatures core{};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};

    /// What lumo requires, and no more.
    static HostFeatures required();
    /// As vkCreateDevice takes them; points into this.
    VkPhysicalDeviceFeatures2 chain();
};

class VulkanHost {
  public:
    struct Asked {
        HostFeatures features = HostFeatures::required();
        std::vector<const char*> extensions = {};
        bool debug_utils = true;  ///< and validation, whose messages come through it
    };
    /// None where there is no Vulkan device, which is a test failure where the environment has LUMO_REQUIRE_APIS=1.
    static std::unique_ptr<VulkanHost> open(const Asked& asked);
    ~VulkanHost();
    VulkanHost(const VulkanHost&) = delete;
    VulkanHost& operator=(const VulkanHost&) = delete;

    /// For adopt_device; points into this.
    backends::vulkan::HostDevice described() const;
    std::string device_name() const;
    VkDevice device() const { return device_; }
    VkQueue queue() const { return queue_; }
    /// Warnings and errors of the layers; those of the host's own end come last.
    std::shared_ptr<std::vector<std::string>> messages() const { return messages_; }

    /// A 2D colour image, in no layout; destroyed with the host or before.
    VkImage image(VkFormat format, uint32_t side, VkImageUsageFlags usage, uint32_t mips = 1);
    void destroy(VkImage image);
    /// In memory that the CPU sees at `mapped`.
    struct Buffer {
        VkBuffer buffer;
        void* mapped;
    };
    Buffer buffer(uint64_t size, VkBufferUsageFlags usage);
    VkSemaphore semaphore(bool timeline);
    /// Records and submits; waits for `wait` (a binary semaphore) before, signals `signal` after.
    void submit(const std::function<void(VkCommandBuffer)>& record, VkSemaphore wait = VK_NULL_HANDLE,
                VkSemaphore signal = VK_NULL_HANDLE);
    void wait_idle() const { vkQueueWaitIdle(queue_); }
    /// The texels of an image in this layout, which may be transferred from; waits.
    std::vector<std::byte> download(VkImage image, VkImageLayout layout, uint32_t side, uint32_t texel_bytes);

  private:
    VulkanHost() = default;
    uint32_t memory_type(uint32_t allowed, VkMemoryPropertyFlags wanted) const;

    HostFeatures features_;
    VkPhysicalDeviceFeatures2 chain_{};
    std::vector<const char*> extensions_;
    std::shared_ptr<std::vector<std::string>> messages_ = std::make_shared<std::vector<std::string>>();
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t family_ = 0;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::vector<VkImage> images_;
    std::vector<VkBuffer> buffers_;
    std::vector<VkDeviceMemory> memories_;
    std::vector<VkSemaphore> semaphores_;
};

/// A transition that waits for all before it and holds back all after it.
void transition(VkCommandBuffer commands, VkImage image, VkImageLayout before, VkImageLayout after);

/// What was written so far is seen by the CPU after a wait.
void show_to_cpu(VkCommandBuffer commands);

}  // namespace lumo::testing_support
