// The RHI's commands as Vulkan's, into one command buffer.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "backends/vulkan/pipelines.hpp"
#include "backends/vulkan/resources.hpp"
#include "backends/vulkan/swapchain.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::vulkan {

/// Everything that handles name, by their index.
struct Store {
    std::vector<Buffer> buffers;
    std::vector<Texture> textures;
    std::vector<Unique<VkSampler>> samplers;
    std::vector<Pipeline> pipelines;

    const Buffer& operator[](rhi::BufferHandle handle) const { return buffers[handle.index]; }
    Texture& operator[](rhi::TextureHandle handle) { return textures[handle.index]; }
    VkSampler operator[](rhi::SamplerHandle handle) const { return samplers[handle.index].get(); }
    const Pipeline& operator[](rhi::PipelineHandle handle) const { return pipelines[handle.index]; }
};

/// Descriptor sets of one submission, for devices without push descriptors.
class DescriptorSets {
  public:
    Result<VkDescriptorSet> allocate(const Gpu& gpu, VkDescriptorSetLayout layout);
    /// Takes back all sets; the device must be done with them.
    void reset(const Gpu& gpu);

  private:
    std::vector<Unique<VkDescriptorPool>> pools_;
    size_t current_ = 0;
};

/// Records the commands of one pass.
class Recorder {
  public:
    /// `slot`: of the submission in flight, for the swapchain.
    Recorder(const Gpu& gpu, Store& store, Swapchain& swapchain, size_t slot, DescriptorSets& sets,
             VkCommandBuffer commands)
        : gpu_(gpu),
          vk_(gpu.vk()),
          store_(store),
          swapchain_(swapchain),
          slot_(slot),
          sets_(sets),
          commands_(commands) {}
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Errors: out_of_memory, for views and descriptor sets that could not be made; those of the swapchain. The
    /// commands that need them are left out.
    Result<void> record(const rhi::EmittedPass& pass);

    void operator()(const rhi::DispatchCommand& command);
    void operator()(const rhi::DispatchIndirectCommand& command);
    void operator()(const rhi::DrawCommand& command);
    void operator()(const rhi::DrawIndexedCommand& command);
    void operator()(const rhi::DrawIndirectCommand& command);
    void operator()(const rhi::ViewportCommand& command);
    void operator()(const rhi::CopyBufferCommand& command);
    void operator()(const rhi::CopyTextureCommand& command);
    void operator()(const rhi::CopyBufferToTextureCommand& command);
    void operator()(const rhi::CopyTextureToBufferCommand& command);
    void operator()(const rhi::FillBufferCommand& command);
    void operator()(const rhi::ClearTextureCommand& command);
    void operator()(const rhi::BlitMipCommand& command);
    void operator()(const rhi::PresentCommand& command) {
        auto shown = swapchain_.record(commands_, store_[command.texture], command.vsync, slot_);
        if (!shown) result_ = shown;
    }

  private:
    void barriers(std::span<const rhi::Barrier> barriers);
    bool begin_rendering(const rhi::RasterTargets& targets);
    /// Descriptors of bindings that a pass uses more than once: commands that bind the same share their values'
    /// place in memory. Points into itself.
    struct PreparedSet {
        const rhi::BindingValue* bindings = nullptr;
        VkDescriptorSet set;  ///< without push descriptors
        std::array<VkWriteDescriptorSet, rhi::max_bindings> writes;
        std::array<VkDescriptorImageInfo, rhi::max_bindings> images;
        std::array<VkDescriptorBufferInfo, rhi::max_bindings> buffers;
    };

    bool bind(const rhi::PipelineBindings& what);
    bool bind_set(const Pipeline& pipeline, std::span<const rhi::BindingValue> bindings);
    bool prepare(const Pipeline& pipeline, std::span<const rhi::BindingValue> bindings,
                 PreparedSet& prepared);
    VkImageView view(const rhi::TextureView& view, rhi::TextureUsage use);
    VkBuffer buffer(const rhi::BufferSlice& slice) const { return store_[slice.buffer].buffer.get(); }
    VkBufferImageCopy copy_region(const rhi::BufferSlice& slice, const Texture& texture,
                                  const rhi::TextureRegion& region) const;

    const Gpu& gpu_;
    const DeviceTable& vk_;
    Store& store_;
    Swapchain& swapchain_;
    size_t slot_;
    DescriptorSets& sets_;
    VkCommandBuffer commands_;
    VkPipeline bound_ = VK_NULL_HANDLE;
    const rhi::BindingValue* bound_bindings_ = nullptr;
    std::array<PreparedSet, 8> prepared_;                  ///< by the place of their bindings
    std::vector<VkBufferMemoryBarrier2> buffer_barriers_;  ///< of one command
    std::vector<VkImageMemoryBarrier2> image_barriers_;
    Result<void> result_;
};

}  // namespace lumo::backends::vulkan
