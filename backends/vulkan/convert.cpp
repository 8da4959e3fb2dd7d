#include "backends/vulkan/convert.hpp"

#include <cstring>

namespace lumo::backends::vulkan {

using rhi::Access;
using rhi::Dimension;
using rhi::Format;
using rhi::Layout;
using rhi::Stages;

VkFormat to_vk(Format format) {
    switch (format) {
        case Format::undefined:
            return VK_FORMAT_UNDEFINED;
        case Format::r8_unorm:
            return VK_FORMAT_R8_UNORM;
        case Format::rg8_unorm:
            return VK_FORMAT_R8G8_UNORM;
        case Format::rgba8_unorm:
            return VK_FORMAT_R8G8B8A8_UNORM;
        case Format::rgba8_srgb:
            return VK_FORMAT_R8G8B8A8_SRGB;
        case Format::rgba8_uint:
            return VK_FORMAT_R8G8B8A8_UINT;
        case Format::rgb10a2_unorm:
            return VK_FORMAT_A2B10G10R10_UNORM_PACK32;
        case Format::r11g11b10_float:
            return VK_FORMAT_B10G11R11_UFLOAT_PACK32;
        case Format::r16_uint:
            return VK_FORMAT_R16_UINT;
        case Format::r16_float:
            return VK_FORMAT_R16_SFLOAT;
        case Format::rg16_float:
            return VK_FORMAT_R16G16_SFLOAT;
        case Format::rgba16_float:
            return VK_FORMAT_R16G16B16A16_SFLOAT;
        case Format::rgba16_unorm:
            return VK_FORMAT_R16G16B16A16_UNORM;
        case Format::r32_uint:
            return VK_FORMAT_R32_UINT;
        case Format::r32_sint:
            return VK_FORMAT_R32_SINT;
        case Format::r32_float:
            return VK_FORMAT_R32_SFLOAT;
        case Format::rg32_uint:
            return VK_FORMAT_R32G32_UINT;
        case Format::rg32_float:
            return VK_FORMAT_R32G32_SFLOAT;
        case Format::rgba32_uint:
            return VK_FORMAT_R32G32B32A32_UINT;
        case Format::rgba32_float:
            return VK_FORMAT_R32G32B32A32_SFLOAT;
        case Format::d32_float:
            return VK_FORMAT_D32_SFLOAT;
        case Format::bc1_rgba_srgb:
            return VK_FORMAT_BC1_RGBA_SRGB_BLOCK;
        case Format::bc3_rgba_srgb:
            return VK_FORMAT_BC3_SRGB_BLOCK;
        case Format::bc4_r_unorm:
            return VK_FORMAT_BC4_UNORM_BLOCK;
        case Format::bc5_rg_unorm:
            return VK_FORMAT_BC5_UNORM_BLOCK;
        case Format::bc6h_rgb_float:
            return VK_FORMAT_BC6H_UFLOAT_BLOCK;
        case Format::bc7_rgba_unorm:
            return VK_FORMAT_BC7_UNORM_BLOCK;
        case Format::bc7_rgba_srgb:
            return VK_FORMAT_BC7_SRGB_BLOCK;
    }
    return VK_FORMAT_UNDEFINED;
}

VkImageAspectFlags aspect_of(Format format) {
    return format == Format::d32_float ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkImageType image_type(Dimension dimension) {
    switch (dimension) {
        case Dimension::d1:
        case Dimension::d1_array:
            return VK_IMAGE_TYPE_1D;
        case Dimension::d3:
            return VK_IMAGE_TYPE_3D;
        default:
            return VK_IMAGE_TYPE_2D;
    }
}

VkImageViewType view_type(Dimension dimension) {
    switch (dimension) {
        case Dimension::d1:
            return VK_IMAGE_VIEW_TYPE_1D;
        case Dimension::d1_array:
            return VK_IMAGE_VIEW_TYPE_1D_ARRAY;
        case Dimension::d2:
        case Dimension::d2_multisample:
            return VK_IMAGE_VIEW_TYPE_2D;
        case Dimension::d2_array:
            return VK_IMAGE_VIEW_TYPE_2D_ARRAY;
        case Dimension::d3:
            return VK_IMAGE_VIEW_TYPE_3D;
        case Dimension::cube:
            return VK_IMAGE_VIEW_TYPE_CUBE;
        case Dimension::cube_array:
            return VK_IMAGE_VIEW_TYPE_CUBE_ARRAY;
    }
    return VK_IMAGE_VIEW_TYPE_2D;
}

VkImageLayout to_vk(Layout layout) {
    switch (layout) {
        case Layout::undefined:
            return VK_IMAGE_LAYOUT_UNDEFINED;
        case Layout::general:
            return VK_IMAGE_LAYOUT_GENERAL;
        case Layout::read_only:
            return VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        case Layout::color_attachment:
            return VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        case Layout::depth_attachment:
            return VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        case Layout::copy_source:
            return VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        case Layout::copy_destination:
            return VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        case Layout::present:
            return VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    }
    return VK_IMAGE_LAYOUT_UNDEFINED;
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
    add(Access::indirect_read, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
    add(Access::index_read, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT);
    add(Access::uniform_read, shaders, VK_ACCESS_2_UNIFORM_READ_BIT);
    add(Access::sampled_read, shaders, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    add(Access::storage_read, shaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
    add(Access::storage_write, shaders, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    add(Access::color_attachment, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    add(Access::depth_attachment,
        VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT);
    add(Access::copy_read, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
    add(Access::copy_write, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    add(Access::host_read, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    return sync;
}

VkPrimitiveTopology to_vk(rhi::Topology topology) {
    switch (topology) {
        case rhi::Topology::triangles:
            return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
        case rhi::Topology::triangle_strip:
            return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP;
        case rhi::Topology::lines:
            return VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
        case rhi::Topology::points:
            return VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
    }
    return VK_PRIMITIVE_TOPOLOGY_MAX_ENUM;
}

VkCullModeFlags to_vk(rhi::CullMode cull) {
    switch (cull) {
        case rhi::CullMode::none:
            return VK_CULL_MODE_NONE;
        case rhi::CullMode::back:
            return VK_CULL_MODE_BACK_BIT;
        case rhi::CullMode::front:
            return VK_CULL_MODE_FRONT_BIT;
    }
    return VK_CULL_MODE_NONE;
}

VkCompareOp to_vk(rhi::Compare compare) {
    static_assert(int(rhi::Compare::less_equal) == VK_COMPARE_OP_LESS_OR_EQUAL &&
                  int(rhi::Compare::always) == VK_COMPARE_OP_ALWAYS);
    return VkCompareOp(compare);
}

VkBlendFactor to_vk(rhi::BlendFactor factor) {
    switch (factor) {
        case rhi::BlendFactor::zero:
            return VK_BLEND_FACTOR_ZERO;
        case rhi::BlendFactor::one:
            return VK_BLEND_FACTOR_ONE;
        case rhi::BlendFactor::source_alpha:
            return VK_BLEND_FACTOR_SRC_ALPHA;
        case rhi::BlendFactor::one_minus_source_alpha:
            return VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        case rhi::BlendFactor::destination_alpha:
            return VK_BLEND_FACTOR_DST_ALPHA;
        case rhi::BlendFactor::one_minus_destination_alpha:
            return VK_BLEND_FACTOR_ONE_MINUS_DST_ALPHA;
        case rhi::BlendFactor::source_color:
            return VK_BLEND_FACTOR_SRC_COLOR;
        case rhi::BlendFactor::destination_color:
            return VK_BLEND_FACTOR_DST_COLOR;
    }
    return VK_BLEND_FACTOR_MAX_ENUM;
}

VkBlendOp to_vk(rhi::BlendOp op) {
    switch (op) {
        case rhi::BlendOp::add:
            return VK_BLEND_OP_ADD;
        case rhi::BlendOp::subtract:
            return VK_BLEND_OP_SUBTRACT;
        case rhi::BlendOp::minimum:
            return VK_BLEND_OP_MIN;
        case rhi::BlendOp::maximum:
            return VK_BLEND_OP_MAX;
    }
    return VK_BLEND_OP_MAX_ENUM;
}

VkAttachmentLoadOp to_vk(rhi::Load load) {
    switch (load) {
        case rhi::Load::clear:
            return VK_ATTACHMENT_LOAD_OP_CLEAR;
        case rhi::Load::keep:
            return VK_ATTACHMENT_LOAD_OP_LOAD;
        case rhi::Load::discard:
            return VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    }
    return VK_ATTACHMENT_LOAD_OP_DONT_CARE;
}

VkClearColorValue to_vk(const rhi::ClearColor& color) {
    VkClearColorValue value;
    std::visit([&](const auto& channels) { std::memcpy(&value, channels.data(), sizeof value); }, color);
    return value;
}

VkIndexType to_vk(rhi::IndexType type) {
    return type == rhi::IndexType::uint16 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32;
}

}  // namespace lumo::backends::vulkan
