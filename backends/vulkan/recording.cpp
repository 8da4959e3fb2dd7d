#include "backends/vulkan/recording.hpp"

#include <algorithm>
#include <cmath>

#include "backends/vulkan/convert.hpp"

namespace lumo::backends::vulkan {

namespace {

using rhi::BindingKind;
using rhi::TextureUsage;

VkImageSubresourceLayers layers_of(const Texture& texture, const rhi::TextureRegion& region) {
    return {texture.aspect(), region.mip, region.first_layer, region.layers};
}

VkOffset3D offset_of(const rhi::TextureRegion& region) {
    return {int32_t(region.x), int32_t(region.y), int32_t(region.z)};
}

VkExtent3D extent_of(const rhi::TextureRegion& region) {
    return {region.extent.width, region.extent.height, region.extent.depth};
}

bool is_integer(rhi::Format format) {
    auto kind = rhi::format_info(format).kind;
    return kind == rhi::FormatKind::uint || kind == rhi::FormatKind::sint;
}

constexpr uint32_t sets_per_pool = 256;

}  // namespace

Result<VkDescriptorSet> DescriptorSets::allocate(const Gpu& gpu, VkDescriptorSetLayout layout) {
    while (true) {
        bool fresh = current_ == pools_.size();
        if (fresh) {
            constexpr VkDescriptorPoolSize sizes[] = {
                {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets_per_pool * 8},
                {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, sets_per_pool * 8},
                {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets_per_pool * 8},
                {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, sets_per_pool * 4},
            };
            VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .maxSets = sets_per_pool,
                                            .poolSizeCount = uint32_t(std::size(sizes)),
                                            .pPoolSizes = sizes};
            auto pool = gpu.make<VkDescriptorPool>(gpu.vk().vkCreateDescriptorPool,
                                                   gpu.vk().vkDestroyDescriptorPool, info, "descriptors");
            if (!pool) return tl::unexpected(pool.error());
            pools_.push_back(std::move(*pool));
        }
        VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .descriptorPool = pools_[current_].get(),
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = &layout};
        VkDescriptorSet set = VK_NULL_HANDLE;
        VkResult result = gpu.vk().vkAllocateDescriptorSets(gpu.device(), &info, &set);
        if (result == VK_SUCCESS) return set;
        if (fresh) return fail(result, "descriptors", "vkAllocateDescriptorSets");
        ++current_;
    }
}

void DescriptorSets::reset(const Gpu& gpu) {
    for (auto& pool : pools_) gpu.vk().vkResetDescriptorPool(gpu.device(), pool.get(), 0);
    current_ = 0;
}

Result<void> Recorder::record(const rhi::EmittedPass& pass) {
    barriers(pass.barriers);
    if (pass.targets && !begin_rendering(*pass.targets)) return result_;
    for (const auto& step : pass.steps) {
        barriers(step.barriers);
        std::visit(*this, step.command);
    }
    if (pass.targets) vk_.vkCmdEndRendering(commands_);
    return result_;
}

void Recorder::barriers(std::span<const rhi::Barrier> barriers) {
    if (barriers.empty()) return;
    auto& buffers = buffer_barriers_;
    auto& images = image_barriers_;
    buffers.clear();
    images.clear();
    for (const auto& barrier : barriers) {
        Sync before = to_vk(barrier.before, barrier.before_stages);
        Sync after = to_vk(barrier.after, barrier.after_stages);
        if (barrier.memory.kind == rhi::MemoryId::Kind::buffer) {
            buffers.push_back({.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
                               .srcStageMask = before.stages,
                               .srcAccessMask = before.access,
                               .dstStageMask = after.stages,
                               .dstAccessMask = after.access,
                               .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                               .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                               .buffer = store_.buffers[barrier.memory.index].buffer.get(),
                               .size = VK_WHOLE_SIZE});
            continue;
        }
        const Texture& texture = store_.textures[barrier.memory.index];
        images.push_back(
            {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
             .srcStageMask = before.stages,
             .srcAccessMask = before.access,
             .dstStageMask = after.stages,
             .dstAccessMask = after.access,
             .oldLayout =
                 barrier.discard ? VK_IMAGE_LAYOUT_UNDEFINED : texture.layout_before(barrier.before_layout),
             .newLayout = texture.layout_after(barrier.after_layout),
             .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
             .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
             .image = texture.image(),
             .subresourceRange = {texture.aspect(), barrier.memory.mip, 1, 0, VK_REMAINING_ARRAY_LAYERS}});
    }
    VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                          .bufferMemoryBarrierCount = uint32_t(buffers.size()),
                          .pBufferMemoryBarriers = buffers.data(),
                          .imageMemoryBarrierCount = uint32_t(images.size()),
                          .pImageMemoryBarriers = images.data()};
    vk_.vkCmdPipelineBarrier2(commands_, &info);
}

bool Recorder::begin_rendering(const rhi::RasterTargets& targets) {
    uint32_t layers = 1;
    auto attachment = [&](const rhi::TextureView& target, rhi::Load load, VkImageLayout layout) {
        layers = target.layers;
        return VkRenderingAttachmentInfo{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                         .imageView = view(target, TextureUsage::attachment),
                                         .imageLayout = layout,
                                         .loadOp = to_vk(load),
                                         .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    };
    std::vector<VkRenderingAttachmentInfo> colors;
    for (const auto& target : targets.color) {
        auto& color = colors.emplace_back(
            attachment(target.view, target.load, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL));
        color.clearValue.color = to_vk(target.clear);
        if (target.resolve) {
            color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
            color.resolveImageView = view(*target.resolve, TextureUsage::attachment);
            color.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        }
    }
    VkRenderingAttachmentInfo depth;
    if (targets.depth) {
        depth = attachment(targets.depth->view, targets.depth->load,
                           VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        depth.clearValue.depthStencil = {targets.depth->clear, 0};
    }
    if (!result_) return false;
    const auto& extent = targets.extent;
    VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                         .renderArea = {{0, 0}, {extent.width, extent.height}},
                         .layerCount = layers,
                         .colorAttachmentCount = uint32_t(colors.size()),
                         .pColorAttachments = colors.data(),
                         .pDepthAttachment = targets.depth ? &depth : nullptr};
    vk_.vkCmdBeginRendering(commands_, &info);
    (*this)(rhi::ViewportCommand{{0, 0, float(extent.width), float(extent.height)}});
    return true;
}

VkImageView Recorder::view(const rhi::TextureView& view, TextureUsage use) {
    Texture& texture = store_[view.texture];
    auto made = texture.view(gpu_, view, use);
    if (made) return *made;
    result_ = tl::unexpected(made.error());
    return VK_NULL_HANDLE;
}

bool Recorder::bind(const rhi::PipelineBindings& what) {
    const Pipeline& pipeline = store_[what.pipeline];
    if (bound_ != pipeline.pipeline.get()) {
        bound_ = pipeline.pipeline.get();
        vk_.vkCmdBindPipeline(commands_, pipeline.bind_point, bound_);
    }
    if (!what.push.empty()) {
        vk_.vkCmdPushConstants(commands_, pipeline.layout.get(), pipeline.stages, 0,
                               uint32_t(what.push.size()), what.push.data());
    }
    return bind_set(pipeline, what.bindings);
}

bool Recorder::bind_set(const Pipeline& pipeline, std::span<const rhi::BindingValue> bindings) {
    if (bindings.empty() || bound_bindings_ == bindings.data()) return true;
    PreparedSet& prepared =
        prepared_[(reinterpret_cast<uintptr_t>(bindings.data()) / alignof(std::max_align_t)) %
                  prepared_.size()];
    if (prepared.bindings != bindings.data() && !prepare(pipeline, bindings, prepared)) return false;
    bound_bindings_ = bindings.data();
    if (gpu_.has_push_descriptors()) {
        vk_.vkCmdPushDescriptorSetKHR(commands_, pipeline.bind_point, pipeline.layout.get(), 0,
                                      uint32_t(bindings.size()), prepared.writes.data());
    } else {
        vk_.vkCmdBindDescriptorSets(commands_, pipeline.bind_point, pipeline.layout.get(), 0, 1,
                                    &prepared.set, 0, nullptr);
    }
    return true;
}

bool Recorder::prepare(const Pipeline& pipeline, std::span<const rhi::BindingValue> bindings,
                       PreparedSet& prepared) {
    prepared.bindings = nullptr;
    for (size_t i = 0; i < bindings.size(); ++i) {
        const auto& value = bindings[i];
        auto& image = prepared.images[i];
        prepared.writes[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                              .dstBinding = pipeline.slots[i].binding,
                              .descriptorCount = 1,
                              .descriptorType = pipeline.slots[i].type,
                              .pImageInfo = &image,
                              .pBufferInfo = &prepared.buffers[i]};
        switch (value.kind) {
            case BindingKind::sampled:
                image = {store_[value.sampler], view(value.view, TextureUsage::sampled),
                         store_[value.view.texture].shader_layout()};
                break;
            case BindingKind::storage_image:
                image = {VK_NULL_HANDLE, view(value.view, TextureUsage::storage), VK_IMAGE_LAYOUT_GENERAL};
                break;
            case BindingKind::storage_buffer:
            case BindingKind::uniform_buffer:
                prepared.buffers[i] = {buffer(value.slice), value.slice.offset, value.slice.size};
                break;
        }
    }
    if (!result_) return false;
    if (!gpu_.has_push_descriptors()) {
        auto set = sets_.allocate(gpu_, pipeline.set_layout.get());
        if (!set) {
            result_ = tl::unexpected(set.error());
            return false;
        }
        const auto count = uint32_t(bindings.size());
        for (uint32_t i = 0; i < count; ++i) prepared.writes[i].dstSet = *set;
        vk_.vkUpdateDescriptorSets(gpu_.device(), count, prepared.writes.data(), 0, nullptr);
        prepared.set = *set;
    }
    prepared.bindings = bindings.data();
    return true;
}

void Recorder::operator()(const rhi::DispatchCommand& command) {
    if (bind(command.what)) vk_.vkCmdDispatch(commands_, command.x, command.y, command.z);
}

void Recorder::operator()(const rhi::DispatchIndirectCommand& command) {
    if (!bind(command.what)) return;
    vk_.vkCmdDispatchIndirect(commands_, buffer(command.arguments), command.arguments.offset);
}

void Recorder::operator()(const rhi::DrawCommand& command) {
    if (!bind(command.what)) return;
    vk_.vkCmdDraw(commands_, command.vertices, command.instances, command.first_vertex, 0);
}

void Recorder::operator()(const rhi::DrawIndexedCommand& command) {
    if (!bind(command.what)) return;
    vk_.vkCmdBindIndexBuffer(commands_, buffer(command.indices), command.indices.offset,
                             to_vk(command.index_type));
    vk_.vkCmdDrawIndexed(commands_, command.count, command.instances, command.first_index,
                         command.vertex_offset, 0);
}

void Recorder::operator()(const rhi::DrawIndirectCommand& command) {
    if (!bind(command.what)) return;
    bool indexed = bool(command.indices.buffer);
    if (indexed) {
        vk_.vkCmdBindIndexBuffer(commands_, buffer(command.indices), command.indices.offset,
                                 to_vk(command.index_type));
    }
    auto draw = indexed ? vk_.vkCmdDrawIndexedIndirect : vk_.vkCmdDrawIndirect;
    uint32_t at_once = gpu_.features().core.multiDrawIndirect ? command.draws : 1;
    for (uint32_t i = 0; i < command.draws; i += at_once) {
        draw(commands_, buffer(command.arguments), command.arguments.offset + uint64_t(i) * command.stride,
             at_once, command.stride);
    }
}

void Recorder::operator()(const rhi::ViewportCommand& command) {
    const auto& v = command.viewport;
    VkViewport viewport{v.x, v.y, v.width, v.height, 0, 1};
    vk_.vkCmdSetViewport(commands_, 0, 1, &viewport);
    auto clip = [](float low, float size) {
        float begin = std::max(std::floor(low), 0.0f);
        float end = std::max(std::ceil(low + size), begin);
        return std::pair(int32_t(begin), uint32_t(end - begin));
    };
    auto [x, width] = clip(v.x, v.width);
    auto [y, height] = clip(v.y, v.height);
    VkRect2D scissor{{x, y}, {width, height}};
    vk_.vkCmdSetScissor(commands_, 0, 1, &scissor);
}

void Recorder::operator()(const rhi::CopyBufferCommand& command) {
    VkBufferCopy region{command.source.offset, command.destination.offset, command.source.size};
    vk_.vkCmdCopyBuffer(commands_, buffer(command.source), buffer(command.destination), 1, &region);
}

void Recorder::operator()(const rhi::CopyTextureCommand& command) {
    const Texture& source = store_[command.source];
    const Texture& destination = store_[command.destination];
    const auto& from = command.source_region;
    const auto& to = command.destination_region;
    VkImageCopy region{layers_of(source, from), offset_of(from), layers_of(destination, to), offset_of(to),
                       extent_of(from)};
    // Within one mip both are the same memory, which can have one layout only.
    bool within = source.image() == destination.image() && from.mip == to.mip;
    vk_.vkCmdCopyImage(commands_, source.image(),
                       within ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                       destination.image(),
                       within ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

VkBufferImageCopy Recorder::copy_region(const rhi::BufferSlice& slice, const Texture& texture,
                                        const rhi::TextureRegion& region) const {
    return {.bufferOffset = slice.offset,
            .imageSubresource = layers_of(texture, region),
            .imageOffset = offset_of(region),
            .imageExtent = extent_of(region)};
}

void Recorder::operator()(const rhi::CopyBufferToTextureCommand& command) {
    const Texture& texture = store_[command.destination];
    auto region = copy_region(command.source, texture, command.region);
    vk_.vkCmdCopyBufferToImage(commands_, buffer(command.source), texture.image(),
                               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void Recorder::operator()(const rhi::CopyTextureToBufferCommand& command) {
    const Texture& texture = store_[command.source];
    auto region = copy_region(command.destination, texture, command.region);
    vk_.vkCmdCopyImageToBuffer(commands_, texture.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               buffer(command.destination), 1, &region);
}

void Recorder::operator()(const rhi::FillBufferCommand& command) {
    vk_.vkCmdFillBuffer(commands_, buffer(command.destination), command.destination.offset,
                        command.destination.size, command.value);
}

void Recorder::operator()(const rhi::ClearTextureCommand& command) {
    const auto& view = command.view;
    const Texture& texture = store_[view.texture];
    VkImageSubresourceRange range{texture.aspect(), view.first_mip, view.mips, view.first_layer, view.layers};
    VkClearColorValue value = to_vk(command.value);
    if (texture.aspect() == VK_IMAGE_ASPECT_DEPTH_BIT) {
        VkClearDepthStencilValue depth{value.float32[0], 0};
        vk_.vkCmdClearDepthStencilImage(commands_, texture.image(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        &depth, 1, &range);
    } else {
        vk_.vkCmdClearColorImage(commands_, texture.image(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1,
                                 &range);
    }
}

void Recorder::operator()(const rhi::BlitMipCommand& command) {
    const Texture& texture = store_[command.texture];
    auto corner = [&](uint32_t mip) {
        auto extent = mip_extent(texture.desc().extent, mip);
        return VkOffset3D{int32_t(extent.width), int32_t(extent.height), int32_t(extent.depth)};
    };
    uint32_t mip = command.source_mip;
    uint32_t layers = texture.desc().layers;
    VkImageBlit blit{.srcSubresource = {texture.aspect(), mip, 0, layers},
                     .srcOffsets = {{}, corner(mip)},
                     .dstSubresource = {texture.aspect(), mip + 1, 0, layers},
                     .dstOffsets = {{}, corner(mip + 1)}};
    vk_.vkCmdBlitImage(commands_, texture.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, texture.image(),
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                       is_integer(texture.desc().format) ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
}

}  // namespace lumo::backends::vulkan
