// The RHI's enumerations in Vulkan's.
#pragma once

#include <vulkan/vulkan.h>

#include "rhi/format.hpp"
#include "rhi/plan.hpp"
#include "rhi/resources.hpp"
#include "rhi/work.hpp"

namespace lumo::backends::vulkan {

VkFormat to_vk(rhi::Format format);
VkImageAspectFlags aspect_of(rhi::Format format);
VkImageType image_type(rhi::Dimension dimension);
VkImageViewType view_type(rhi::Dimension dimension);
VkImageLayout to_vk(rhi::Layout layout);
VkShaderStageFlags to_vk(rhi::Stages stages);
VkDescriptorType to_vk(rhi::BindingKind kind);
VkPrimitiveTopology to_vk(rhi::Topology topology);
VkCullModeFlags to_vk(rhi::CullMode cull);
VkCompareOp to_vk(rhi::Compare compare);
VkBlendFactor to_vk(rhi::BlendFactor factor);
VkBlendOp to_vk(rhi::BlendOp op);
VkFilter to_vk(rhi::FilterMode mode);
VkSamplerAddressMode to_vk(rhi::AddressMode mode);
VkBorderColor to_vk(rhi::BorderColor border);
VkAttachmentLoadOp to_vk(rhi::Load load);
VkClearColorValue to_vk(const rhi::ClearColor& color);
VkIndexType to_vk(rhi::IndexType type);

/// Pipeline stages and accesses of one side of a dependency.
struct Sync {
    VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
    VkAccessFlags2 access = VK_ACCESS_2_NONE;
};
/// `stages` says where uniform, sampled and storage accesses happen.
Sync to_vk(rhi::Access access, rhi::Stages stages);

}  // namespace lumo::backends::vulkan
