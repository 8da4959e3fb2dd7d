#include "backends/vulkan/convert.hpp"

#include <array>
#include <cstring>

namespace lumo::backends::vulkan {

using rhi::Access;
using rhi::Stages;

// Tables are in the order of the RHI's enumerators.

VkFormat to_vk(rhi::Format format) {
    constexpr std::array<VkFormat, rhi::format_count> formats = {
        VK_FORMAT_UNDEFINED,
        VK_FORMAT_R8_UNORM,
        VK_FORMAT_R8G8_UNORM,
        VK_FORMAT_R8G8B8A8_UNORM,
        VK_FORMAT_R8G8B8A8_SRGB,
        VK_FORMAT_R8G8B8A8_UINT,
        VK_FORMAT_A2B10G10R10_UNORM_PACK32,
        VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_R16_UINT,
        VK_FORMAT_R16_SFLOAT,
        VK_FORMAT_R16G16_SFLOAT,
        VK_FORMAT_R16G16B16A16_SFLOAT,
        VK_FORMAT_R16G16B16A16_UNORM,
        VK_FORMAT_R32_UINT,
        VK_FORMAT_R32_SINT,
        VK_FORMAT_R32_SFLOAT,
        VK_FORMAT_R32G32_UINT,
        VK_FORMAT_R32G32_SFLOAT,
        VK_FORMAT_R32G32B32A32_UINT,
        VK_FORMAT_R32G32B32A32_SFLOAT,
        VK_FORMAT_D32_SFLOAT,
        VK_FORMAT_BC1_RGBA_SRGB_BLOCK,
        VK_FORMAT_BC3_SRGB_BLOCK,
        VK_FORMAT_BC4_UNORM_BLOCK,
        VK_FORMAT_BC5_UNORM_BLOCK,
        VK_FORMAT_BC6H_UFLOAT_BLOCK,
        VK_FORMAT_BC7_UNORM_BLOCK,
        VK_FORMAT_BC7_SRGB_BLOCK,
    };
    static_assert(formats[size_t(rhi::Format::d32_float)] == VK_FORMAT_D32_SFLOAT &&
                  formats.back() == VK_FORMAT_BC7_SRGB_BLOCK);
    return formats[size_t(format)];
}

VkImageAspectFlags aspect_of(rhi::Format format) {
    return format == rhi::Format::d32_float ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkImageType image_type(rhi::Dimension dimension) {
    switch (view_type(dimension)) {
        case VK_IMAGE_VIEW_TYPE_1D:
        case VK_IMAGE_VIEW_TYPE_1D_ARRAY:
            return VK_IMAGE_TYPE_1D;
        case VK_IMAGE_VIEW_TYPE_3D:
            return VK_IMAGE_TYPE_3D;
        default:
            return VK_IMAGE_TYPE_2D;
    }
}

VkImageViewType view_type(rhi::Dimension dimension) {
    constexpr VkImageViewType types[] = {VK_IMAGE_VIEW_TYPE_1D,         VK_IMAGE_VIEW_TYPE_2D,
                                         VK_IMAGE_VIEW_TYPE_3D,         VK_IMAGE_VIEW_TYPE_CUBE,
                                         VK_IMAGE_VIEW_TYPE_1D_ARRAY,   VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                         VK_IMAGE_VIEW_TYPE_CUBE_ARRAY, VK_IMAGE_VIEW_TYPE_2D};
    static_assert(std::size(types) == size_t(rhi::Dimension::d2_multisample) + 1);
    return types[size_t(dimension)];
}

VkImageLayout to_vk(rhi::Layout layout) {
    constexpr VkImageLayout layouts[] = {
        VK_IMAGE_LAYOUT_UNDEFINED,
        VK_IMAGE_LAYOUT_GENERAL,
        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
    };
    static_assert(std::size(layouts) == size_t(rhi::Layout::external));
    return layouts[size_t(layout)];
}

VkShaderStageFlags to_vk(Stages stages) {
    VkShaderStageFlags bits = 0;
    if (has(stages, Stages::vertex)) bits |= VK_SHADER_STAGE_VERTEX_BIT;
    if (has(stages, Stages::geometry)) bits |= VK_SHADER_STAGE_GEOMETRY_BIT;
    if (has(stages, Stages::fragment)) bits |= VK_SHADER_STAGE_FRAGMENT_BIT;
    if (has(stages, Stages::compute)) bits |= VK_SHADER_STAGE_COMPUTE_BIT;
    return bits;
}

Sync to_vk(Access access, Stages stages) {
    VkPipelineStageFlags2 shaders = VK_PIPELINE_STAGE_2_NONE;
    if (has(stages, Stages::vertex)) shaders |= VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT;
    if (has(stages, Stages::geometry)) shaders |= VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT;
    if (has(stages, Stages::fragment)) shaders |= VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
    if (has(stages, Stages::compute)) shaders |= VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;

    Sync sync;
    auto add = [&](Access bit, VkPipelineStageFlags2 where, VkAccessFlags2 what) {
        if (!has(access, bit)) return;
        sync.stages |= where;
        sync.access |= what;
    };
    add(Access::uniform_read, shaders, VK_ACCESS_2_UNIFORM_READ_BIT);
    add(Access::sampled_read, shaders, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    add(Access::storage_read, shaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
    add(Access::storage_write, shaders, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    constexpr Access by_shaders =
        Access::uniform_read | Access::sampled_read | Access::storage_read | Access::storage_write;
    if ((access | by_shaders) == by_shaders) return sync;  // as most are
    add(Access::indirect_read, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
    add(Access::index_read, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT);
    add(Access::color_attachment, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    add(Access::depth_attachment,
        VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT);
    add(Access::copy_read, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
    add(Access::copy_write, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    add(Access::external, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
    add(Access::host_read, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    return sync;
}

VkDescriptorType to_vk(rhi::BindingKind kind) {
    constexpr VkDescriptorType types[] = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                          VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                          VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER};
    return types[size_t(kind)];
}

VkPrimitiveTopology to_vk(rhi::Topology topology) {
    constexpr VkPrimitiveTopology topologies[] = {
        VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP,
        VK_PRIMITIVE_TOPOLOGY_LINE_LIST, VK_PRIMITIVE_TOPOLOGY_POINT_LIST};
    return topologies[size_t(topology)];
}

VkCullModeFlags to_vk(rhi::CullMode cull) {
    constexpr VkCullModeFlags modes[] = {VK_CULL_MODE_NONE, VK_CULL_MODE_BACK_BIT, VK_CULL_MODE_FRONT_BIT};
    return modes[size_t(cull)];
}

VkCompareOp to_vk(rhi::Compare compare) {
    static_assert(int(rhi::Compare::less_equal) == VK_COMPARE_OP_LESS_OR_EQUAL &&
                  int(rhi::Compare::always) == VK_COMPARE_OP_ALWAYS);
    return VkCompareOp(compare);
}

VkBlendFactor to_vk(rhi::BlendFactor factor) {
    constexpr VkBlendFactor factors[] = {VK_BLEND_FACTOR_ZERO,      VK_BLEND_FACTOR_ONE,
                                         VK_BLEND_FACTOR_SRC_ALPHA, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                         VK_BLEND_FACTOR_DST_ALPHA, VK_BLEND_FACTOR_ONE_MINUS_DST_ALPHA,
                                         VK_BLEND_FACTOR_SRC_COLOR, VK_BLEND_FACTOR_DST_COLOR};
    return factors[size_t(factor)];
}

VkBlendOp to_vk(rhi::BlendOp op) {
    constexpr VkBlendOp ops[] = {VK_BLEND_OP_ADD, VK_BLEND_OP_SUBTRACT, VK_BLEND_OP_MIN, VK_BLEND_OP_MAX};
    return ops[size_t(op)];
}

VkFilter to_vk(rhi::FilterMode mode) {
    return mode == rhi::FilterMode::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
}

VkSamplerAddressMode to_vk(rhi::AddressMode mode) {
    constexpr VkSamplerAddressMode modes[] = {
        VK_SAMPLER_ADDRESS_MODE_REPEAT, VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT,
        VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER};
    return modes[size_t(mode)];
}

VkBorderColor to_vk(rhi::BorderColor border) {
    constexpr VkBorderColor borders[] = {VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK,
                                         VK_BORDER_COLOR_FLOAT_OPAQUE_BLACK,
                                         VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE};
    return borders[size_t(border)];
}

VkAttachmentLoadOp to_vk(rhi::Load load) {
    constexpr VkAttachmentLoadOp ops[] = {VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_LOAD_OP_LOAD,
                                          VK_ATTACHMENT_LOAD_OP_DONT_CARE};
    return ops[size_t(load)];
}

VkIndexType to_vk(rhi::IndexType type) {
    return type == rhi::IndexType::uint16 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32;
}

VkClearColorValue to_vk(const rhi::ClearColor& color) {
    VkClearColorValue value;
    std::visit([&](const auto& channels) { std::memcpy(&value, channels.data(), sizeof value); }, color);
    return value;
}

}  // namespace lumo::backends::vulkan
