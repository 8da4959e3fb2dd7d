// Buffers, textures with their views, and samplers.
#pragma once

#include <utility>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "backends/vulkan/memory.hpp"
#include "rhi/native.hpp"
#include "rhi/plan.hpp"
#include "rhi/resources.hpp"

namespace lumo::backends::vulkan {

struct Buffer {
    Allocation memory{};
    Unique<VkBuffer> buffer;
};

Result<Buffer> create_buffer(const Gpu& gpu, Allocator& allocator, const rhi::BufferDesc& desc);
/// A host's. Error: unsupported (the device is not).
Result<Buffer> adopt_buffer(const Gpu& gpu, const rhi::BufferDesc& desc, const rhi::NativeBuffer& native);

class Texture {
  public:
    Texture() = default;
    /// Errors: unsupported (the format, size or use), out_of_memory.
    static Result<Texture> create(const Gpu& gpu, Allocator& allocator, const rhi::TextureDesc& desc);

    /// A host's image. Errors: unsupported (likewise), invalid_argument (a layout that no image can be left in).
    static Result<Texture> adopt(const Gpu& gpu, const rhi::TextureDesc& desc,
                                 const rhi::NativeTexture& native);

    VkImage image() const { return image_.get(); }
    const rhi::TextureDesc& desc() const { return desc_; }
    /// Of an image of lumo's own.
    uint64_t allocated_bytes() const { return memory_->size; }
    VkImageAspectFlags aspect() const;
    /// For the two sides of a barrier.
    VkImageLayout layout_before(rhi::Layout layout) const;
    VkImageLayout layout_after(rhi::Layout layout) const;
    /// The layout in which shaders use it.
    VkImageLayout shader_layout() const;

    /// Made on first use and kept. It allows `use` alone, because the view's format may not have all uses of
    /// the texture. Error: out_of_memory.
    Result<VkImageView> view(const Gpu& gpu, const rhi::TextureView& view, rhi::TextureUsage use);

  private:
    rhi::TextureDesc desc_;
    Allocation memory_{};
    Unique<VkImage> image_;
    rhi::NativeTexture native_;  ///< layouts of a host's image
    std::vector<std::pair<std::pair<rhi::TextureView, rhi::TextureUsage>, Unique<VkImageView>>> views_;
};

Result<Unique<VkSampler>> create_sampler(const Gpu& gpu, const rhi::SamplerDesc& desc);

}  // namespace lumo::backends::vulkan
