// A small renderer that knows nothing of lumo: plain Vulkan 1.3 with dynamic rendering and descriptor sets. It draws a
// G-buffer of its scene, shades it with its sun, and draws a triangle of its own over the picture. Rows of its images
// run from the top, as Vulkan's users are used to, unlike lumo's own.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>
#include <vulkan/vulkan.h>

#include "samples/embed-vulkan/scene.hpp"

namespace embed {

/// Throws std::runtime_error where the call failed.
void check(VkResult result, const char* call);

struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkFormat format = VK_FORMAT_UNDEFINED;
};

struct HostOptions {
    bool validation = false;  ///< with synchronization validation; its messages go to stderr and are counted
    uint32_t width = 960;
    uint32_t height = 540;
    std::span<const char* const> surface_extensions = {};  ///< of the instance, for a window
};

class Host {
  public:
    explicit Host(const HostOptions& options);
    ~Host();
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

    /// The scene's surfaces into albedo, normal and depth, which are left in SHADER_READ_ONLY_OPTIMAL.
    void draw_gbuffer(const Camera& camera);
    /// The picture from the G-buffer: sunlight, and where asked the indirect irradiance, which is to be in
    /// SHADER_READ_ONLY_OPTIMAL; then the triangle. Left in TRANSFER_SRC_OPTIMAL.
    void compose(const Camera& camera, bool with_indirect);
    /// The picture's texels, RGBA with 8 bits each, row 0 at the top.
    std::vector<uint8_t> read_picture();

    /// Records and submits.
    void run(const std::function<void(VkCommandBuffer)>& record, VkSemaphore wait = VK_NULL_HANDLE,
             VkSemaphore signal = VK_NULL_HANDLE);
    /// Waits for all that was submitted, once a frame: a host that cared for speed would have two in flight.
    void finish();

    // What a guest is told.
    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical_device() const { return physical_; }
    VkDevice device() const { return device_; }
    VkQueue queue() const { return queue_; }
    uint32_t queue_family() const { return family_; }
    /// What the device was made with; whoever makes a device has to keep this for its guests.
    const VkPhysicalDeviceFeatures2& features() const { return features_; }
    std::span<const char* const> device_extensions() const { return device_extensions_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const Image& normal() const { return normal_; }          ///< RGBA16F, world space; 0 in the sky
    const Image& depth() const { return depth_; }            ///< D32F, 1 in the sky
    const Image& irradiance() const { return irradiance_; }  ///< RGBA32F, W/m²
    const Image& picture() const { return picture_; }        ///< RGBA8 sRGB
    int messages() const { return messages_; }               ///< of the validation layers so far

  private:
    void make_instance(const HostOptions& options);
    void make_device(bool presents);
    Image make_image(VkFormat format, VkImageUsageFlags usage);
    void make_boxes();
    void make_descriptors();
    VkPipeline make_pipeline(std::span<const uint32_t> vertex, std::span<const uint32_t> fragment,
                             std::span<const VkFormat> colors, bool depth);
    uint32_t memory_type(uint32_t allowed, VkMemoryPropertyFlags wanted) const;
    /// A buffer that the CPU writes or reads.
    std::pair<VkBuffer, VkDeviceMemory> make_buffer(VkDeviceSize size, VkBufferUsageFlags usage);
    void begin_rendering(VkCommandBuffer commands, std::span<const Image* const> colors, const Image* depth,
                         VkPipeline pipeline) const;
    static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data,
                                                     void* host);

    uint32_t width_, height_;
    int messages_ = 0;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkPhysicalDeviceVulkan13Features features13_{};
    VkPhysicalDeviceVulkan12Features features12_{};
    VkPhysicalDeviceFeatures2 features_{};
    std::vector<const char*> device_extensions_;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t family_ = 0;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::vector<VkCommandBuffer> submitted_;  ///< since finish()

    Image albedo_, normal_, depth_, irradiance_, picture_;
    VkBuffer boxes_ = VK_NULL_HANDLE;
    VkDeviceMemory boxes_memory_ = VK_NULL_HANDLE;
    VkSampler sampler_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptor_pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline gbuffer_pipeline_ = VK_NULL_HANDLE;
    VkPipeline compose_pipeline_ = VK_NULL_HANDLE;
    VkPipeline triangle_pipeline_ = VK_NULL_HANDLE;
};

/// Changes an image's layout; what comes after waits for all that came before.
void transition(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout before,
                VkImageLayout after);

}  // namespace embed
