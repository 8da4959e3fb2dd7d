// Buffers, textures with their views, and samplers.
#pragma once

#include <utility>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "backends/vulkan/memory.hpp"
#include "rhi/resources.hpp"

namespace lumo::backends::vulkan {

struct Buffer {
    Allocation memory{};
    Unique<VkBuffer> buffer;
};

Result<Buffer> create_buffer(const Gpu& gpu, Allocator& allocator, const rhi::BufferDesc& desc);

class Texture {
  public:
    Texture() = default;
    /// Errors: unsupported (the format, size or use), out_of_memory.
    static Result<Texture> create(const Gpu& gpu, Allocator& allocator, const rhi::TextureDesc& desc);

    VkImage image() const { return image_.get(); }
    const rhi::TextureDesc& desc() const { return desc_; }
    uint64_t allocated_bytes() const { return memory_->size; }
    VkImageAspectFlags aspect() const;
    /// The layout in which shaders use it.
    VkImageLayout shader_layout() const;

    /// Made on first use and kept. It allows `use` alone, because the view's format may not have all uses of
    /// the texture. Error: out_of_memory.
    Result<VkImageView> view(const Gpu& gpu, const rhi::TextureView& view, rhi::TextureUsage use);

  private:
    rhi::TextureDesc desc_;
    Allocation memory_{};
    Unique<VkImage> image_;
    std::vector<std::pair<std::pair<rhi::TextureView, rhi::TextureUsage>, Unique<VkImageView>>> views_;
};

Result<Unique<VkSampler>> create_sampler(const Gpu& gpu, const rhi::SamplerDesc& desc);

}  // namespace lumo::backends::vulkan
