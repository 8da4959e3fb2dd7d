#include "backends/vulkan/resources.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "backends/vulkan/convert.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::vulkan {

namespace {

using rhi::BufferUsage;
using rhi::Dimension;
using rhi::TextureUsage;

VkImageUsageFlags image_usage(TextureUsage usage, rhi::Format format) {
    VkImageUsageFlags bits = 0;
    if (has(usage, TextureUsage::sampled)) bits |= VK_IMAGE_USAGE_SAMPLED_BIT;
    if (has(usage, TextureUsage::storage)) bits |= VK_IMAGE_USAGE_STORAGE_BIT;
    if (has(usage, TextureUsage::attachment)) {
        bits |= aspect_of(format) == VK_IMAGE_ASPECT_DEPTH_BIT ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                               : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    }
    return bits;
}

/// An attachment sees the faces of a cube as layers.
Dimension attachment_dimension(Dimension dimension) {
    bool cube = dimension == Dimension::cube || dimension == Dimension::cube_array;
    return cube ? Dimension::d2_array : dimension;
}

bool may_be_cube(const rhi::TextureDesc& desc) {
    return image_type(desc.dimension) == VK_IMAGE_TYPE_2D && desc.samples == 1 && desc.layers >= 6 &&
           desc.extent.width == desc.extent.height;
}

/// What Vulkan is asked about an image before there is one. It points into itself.
struct ImageShape {
    ImageShape(const rhi::TextureDesc& desc, VkImageUsageFlags more_usage) {
        formats.push_back(to_vk(desc.format));
        for (auto format : desc.view_formats) formats.push_back(to_vk(format));
        list = {.sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_LIST_CREATE_INFO,
                .viewFormatCount = uint32_t(formats.size()),
                .pViewFormats = formats.data()};
        asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_IMAGE_FORMAT_INFO_2,
                 .format = formats[0],
                 .type = image_type(desc.dimension),
                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                 .usage = image_usage(desc.usage, desc.format) | more_usage};
        if (may_be_cube(desc)) asked.flags |= VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT;
        if (formats.size() == 1) return;
        asked.pNext = &list;
        // Extended usage: a view in another format may be stored to where the texture's own format may not.
        asked.flags |= VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT | VK_IMAGE_CREATE_EXTENDED_USAGE_BIT;
    }
    ImageShape(const ImageShape&) = delete;
    ImageShape& operator=(const ImageShape&) = delete;

    std::vector<VkFormat> formats;
    VkImageFormatListCreateInfo list;
    VkPhysicalDeviceImageFormatInfo2 asked;
};

/// Error: unsupported.
Result<void> check_shape(const Gpu& gpu, const rhi::TextureDesc& desc,
                         const VkPhysicalDeviceImageFormatInfo2& asked) {
    if (desc.dimension == Dimension::cube_array && !gpu.features().core.imageCubeArray)
        return fail(ErrorKind::unsupported, desc.name, "this device was made without imageCubeArray",
                    "enable it with the host's device, or use another device");
    VkImageFormatProperties2 allowed{.sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_PROPERTIES_2};
    VkResult result = gpu.instance().vk().image_format_properties(gpu.physical(), &asked, &allowed);
    const auto& limit = allowed.imageFormatProperties;
    if (result != VK_SUCCESS) {
        return fail(ErrorKind::unsupported, desc.name,
                    fmt::format("the device has no {} texture of this shape and use",
                                rhi::format_info(desc.format).name));
    }
    if (desc.extent.width > limit.maxExtent.width || desc.extent.height > limit.maxExtent.height ||
        desc.extent.depth > limit.maxExtent.depth || desc.layers > limit.maxArrayLayers ||
        desc.mips > limit.maxMipLevels || !(desc.samples & limit.sampleCounts)) {
        return fail(
            ErrorKind::unsupported, desc.name,
            fmt::format("{}x{}x{} texels, {} layers, {} mips, {} samples; the device has at most "
                        "{}x{}x{}, {}, {}, and sample counts by bits {:#x}",
                        desc.extent.width, desc.extent.height, desc.extent.depth, desc.layers, desc.mips,
                        desc.samples, limit.maxExtent.width, limit.maxExtent.height, limit.maxExtent.depth,
                        limit.maxArrayLayers, limit.maxMipLevels, limit.sampleCounts));
    }
    return {};
}

}  // namespace

Result<Buffer> create_buffer(const Gpu& gpu, Allocator& allocator, const rhi::BufferDesc& desc) {
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (has(desc.usage, BufferUsage::storage)) usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    if (has(desc.usage, BufferUsage::uniform)) usage |= VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    if (has(desc.usage, BufferUsage::index)) usage |= VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    if (has(desc.usage, BufferUsage::indirect)) usage |= VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = desc.size, .usage = usage};
    auto buffer = gpu.make<VkBuffer>(gpu.vk().vkCreateBuffer, gpu.vk().vkDestroyBuffer, info, desc.name,
                                     VK_OBJECT_TYPE_BUFFER);
    if (!buffer) return tl::unexpected(buffer.error());
    auto memory = allocator.bind(buffer->get(), VK_NULL_HANDLE, desc.memory, desc.name);
    if (!memory) return tl::unexpected(memory.error());
    return Buffer{std::move(*memory), std::move(*buffer)};
}

Result<Buffer> adopt_buffer(const Gpu& gpu, const rhi::BufferDesc& desc, const rhi::NativeBuffer& native) {
    if (!gpu.is_adopted()) return rhi::not_adopted(desc.name);
    return Buffer{{}, Unique<VkBuffer>(gpu.device(), handle_of<VkBuffer>(native.object), nullptr)};
}

Result<Texture> Texture::create(const Gpu& gpu, Allocator& allocator, const rhi::TextureDesc& desc) {
    const ImageShape shape(desc, VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    const auto& asked = shape.asked;
    if (auto fine = check_shape(gpu, desc, asked); !fine) return tl::unexpected(fine.error());
    VkImageCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .pNext = asked.pNext,
        .flags = asked.flags,
        .imageType = asked.type,
        .format = asked.format,
        .extent = {desc.extent.width, desc.extent.height, desc.extent.depth},
        .mipLevels = desc.mips,
        .arrayLayers = desc.layers,
        .samples = VkSampleCountFlagBits(desc.samples),
        .tiling = asked.tiling,
        .usage = asked.usage,
    };
    auto image = gpu.make<VkImage>(gpu.vk().vkCreateImage, gpu.vk().vkDestroyImage, info, desc.name,
                                   VK_OBJECT_TYPE_IMAGE);
    if (!image) return tl::unexpected(image.error());
    auto memory = allocator.bind(VK_NULL_HANDLE, image->get(), rhi::Memory::device, desc.name);
    if (!memory) return tl::unexpected(memory.error());
    Texture made;
    made.desc_ = desc;
    made.memory_ = std::move(*memory);
    made.image_ = std::move(*image);
    return made;
}

Result<Texture> Texture::adopt(const Gpu& gpu, const rhi::TextureDesc& desc,
                               const rhi::NativeTexture& native) {
    if (!gpu.is_adopted()) return rhi::not_adopted(desc.name);
    const auto after = VkImageLayout(native.layout_after);
    if (after == VK_IMAGE_LAYOUT_UNDEFINED || after == VK_IMAGE_LAYOUT_PREINITIALIZED)
        return fail(ErrorKind::invalid_argument, desc.name,
                    "layout_after is undefined or preinitialized, which no image can be left in",
                    "name the layout that the host goes on with");
    // Not the uses that lumo's own textures have besides: the host's image may lack them.
    if (auto fine = check_shape(gpu, desc, ImageShape(desc, 0).asked); !fine)
        return tl::unexpected(fine.error());
    Texture made;
    made.desc_ = desc;
    made.image_ = Unique<VkImage>(gpu.device(), handle_of<VkImage>(native.object), nullptr);
    made.native_ = native;
    return made;
}

VkImageLayout Texture::layout_before(rhi::Layout layout) const {
    return layout == rhi::Layout::external ? VkImageLayout(native_.layout_before) : to_vk(layout);
}

VkImageLayout Texture::layout_after(rhi::Layout layout) const {
    return layout == rhi::Layout::external ? VkImageLayout(native_.layout_after) : to_vk(layout);
}

VkImageAspectFlags Texture::aspect() const { return aspect_of(desc_.format); }

VkImageLayout Texture::shader_layout() const {
    return to_vk(has(desc_.usage, TextureUsage::storage) ? rhi::Layout::general : rhi::Layout::read_only);
}

Result<VkImageView> Texture::view(const Gpu& gpu, const rhi::TextureView& view, TextureUsage use) {
    for (const auto& [key, made] : views_) {
        if (key.first == view && key.second == use) return made.get();
    }
    bool attachment = use == TextureUsage::attachment;
    VkImageViewUsageCreateInfo usage{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO,
                                     .usage = image_usage(use, desc_.format)};
    VkImageViewCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .pNext = &usage,
        .image = image(),
        .viewType = view_type(attachment ? attachment_dimension(view.dimension) : view.dimension),
        .format = to_vk(view.format),
        .subresourceRange = {aspect(), view.first_mip, view.mips, view.first_layer, view.layers},
    };
    auto made = gpu.make<VkImageView>(gpu.vk().vkCreateImageView, gpu.vk().vkDestroyImageView, info,
                                      desc_.name, VK_OBJECT_TYPE_IMAGE_VIEW);
    if (!made) return tl::unexpected(made.error());
    return views_.emplace_back(std::pair(view, use), std::move(*made)).second.get();
}

Result<Unique<VkSampler>> create_sampler(const Gpu& gpu, const rhi::SamplerDesc& desc) {
    float anisotropy = std::min(desc.max_anisotropy, gpu.info().limits.max_anisotropy);
    VkSamplerCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = to_vk(desc.magnification),
        .minFilter = to_vk(desc.minification),
        .mipmapMode = desc.mip == rhi::FilterMode::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR
                                                          : VK_SAMPLER_MIPMAP_MODE_NEAREST,
        .addressModeU = to_vk(desc.address_u),
        .addressModeV = to_vk(desc.address_v),
        .addressModeW = to_vk(desc.address_w),
        .anisotropyEnable = anisotropy > 1,
        .maxAnisotropy = anisotropy,
        .minLod = desc.min_lod,
        .maxLod = desc.max_lod,
        .borderColor = to_vk(desc.border),
    };
    return gpu.make<VkSampler>(gpu.vk().vkCreateSampler, gpu.vk().vkDestroySampler, info, "sampler");
}

}  // namespace lumo::backends::vulkan
