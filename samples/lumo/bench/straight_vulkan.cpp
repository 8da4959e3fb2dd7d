// The work of `lumo bench rhi` by Vulkan's own calls, as a program without lumo would make them: one memory
// barrier between dependent dispatches, push descriptors, dynamic rendering. Only what is not measured, the
// device, memory and pipelines, is made by the backend.
#include <cstring>

#include "backends/vulkan/gpu.hpp"
#include "backends/vulkan/memory.hpp"
#include "backends/vulkan/pipelines.hpp"
#include "backends/vulkan/resources.hpp"
#include "rhi/backend.hpp"
#include "samples/lumo/bench/rhi_work.hpp"

namespace lumo::program {
namespace {

namespace vulkan = backends::vulkan;
using shaders::bench_rhi::mark;
using shaders::bench_rhi::step;

class StraightVulkan final : public RhiWork {
  public:
    explicit StraightVulkan(std::unique_ptr<vulkan::Gpu> gpu)
        : gpu_(std::move(gpu)), vk_(gpu_->vk()), allocator_(*gpu_), cache_(*gpu_, false) {}
    ~StraightVulkan() override { vk_.vkDeviceWaitIdle(gpu_->device()); }
    Result<void> prepare();

    Result<double> dispatches(uint32_t count) override;
    Result<double> draws(uint32_t count) override;
    Result<std::vector<std::byte>> outcome() override;
    Result<double> transfer(Transfer what) override;

  private:
    /// Of one submission, from opening the command buffer to submitting it; then waits.
    template <class Record>
    Result<double> submitted(Record record);
    void order(VkPipelineStageFlags2 before, VkAccessFlags2 written, VkPipelineStageFlags2 after,
               VkAccessFlags2 used) const;
    void change_layout(VkImage image, VkImageLayout from, VkImageLayout to) const;
    void push_bindings(const vulkan::Pipeline& pipeline, std::span<const VkWriteDescriptorSet> writes) const;
    VkImageView view(vulkan::Texture& texture, rhi::TextureUsage use);
    Result<std::vector<std::byte>> read(VkBuffer source, uint64_t size);

    std::unique_ptr<vulkan::Gpu> gpu_;
    const vulkan::DeviceTable& vk_;
    vulkan::Allocator allocator_;
    vulkan::PipelineCache cache_;
    /// As many as lumo has in flight, used in turn.
    vulkan::Unique<VkCommandPool> pools_[rhi::max_in_flight];
    VkCommandBuffer command_buffers_[rhi::max_in_flight]{};
    vulkan::Unique<VkSemaphore> done_;
    uint64_t serial_ = 0;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;  ///< of the submission that is being recorded
    vulkan::Pipeline step_, mark_;
    vulkan::Unique<VkSampler> sampler_;
    vulkan::Texture pictures_[2], target_, transfer_texture_;
    VkImageView picture_views_[2]{}, target_view_ = VK_NULL_HANDLE;
    vulkan::Buffer items_[2], corners_, upload_, readback_, transfer_buffer_;
    std::vector<std::byte> bytes_ = std::vector<std::byte>(transfer_bytes, std::byte{7});
};

template <class Record>
Result<double> StraightVulkan::submitted(Record record) {
    const CpuTimer timer;
    const size_t slot = ++serial_ % rhi::max_in_flight;
    commands_ = command_buffers_[slot];
    vk_.vkResetCommandPool(gpu_->device(), pools_[slot].get(), 0);
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    vk_.vkBeginCommandBuffer(commands_, &begin);
    record();
    vk_.vkEndCommandBuffer(commands_);
    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = commands_};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = done_.get(),
                                       .value = serial_,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands,
                             .signalSemaphoreInfoCount = 1,
                             .pSignalSemaphoreInfos = &signal};
    VkResult result = vk_.vkQueueSubmit2(gpu_->queue(), 1, &info, VK_NULL_HANDLE);
    const double seconds = timer.seconds();
    VkSemaphore done = done_.get();
    const VkSemaphoreWaitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &done,
                                   .pValues = &serial_};
    if (result == VK_SUCCESS) result = vk_.vkWaitSemaphores(gpu_->device(), &wait, UINT64_MAX);
    if (result != VK_SUCCESS) return vulkan::fail(result, gpu_->info().name, "a submission");
    return seconds;
}

void StraightVulkan::order(VkPipelineStageFlags2 before, VkAccessFlags2 written, VkPipelineStageFlags2 after,
                           VkAccessFlags2 used) const {
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = before,
                                   .srcAccessMask = written,
                                   .dstStageMask = after,
                                   .dstAccessMask = used};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vk_.vkCmdPipelineBarrier2(commands_, &info);
}

void StraightVulkan::change_layout(VkImage image, VkImageLayout from, VkImageLayout to) const {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = 1,
                                .pImageMemoryBarriers = &barrier};
    vk_.vkCmdPipelineBarrier2(commands_, &info);
}

VkBufferImageCopy whole(uint32_t side) {
    return {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {side, side, 1}};
}

Result<void> StraightVulkan::prepare() {
    Keep keep;
    using rhi::Memory;
    const auto buffer = [&](uint64_t size, Memory memory) {
        return vulkan::create_buffer(*gpu_, allocator_, {.name = "bench", .size = size, .memory = memory});
    };
    const auto texture = [&](uint32_t side, rhi::TextureUsage usage) {
        return vulkan::Texture::create(*gpu_, allocator_,
                                       {.name = "bench", .extent = {side, side, 1}, .usage = usage});
    };
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .queueFamilyIndex = gpu_->queue_family()};
    for (auto& made : pools_)
        keep(made,
             gpu_->make<VkCommandPool>(vk_.vkCreateCommandPool, vk_.vkDestroyCommandPool, pool, "bench"));
    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo done{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    keep(done_, gpu_->make<VkSemaphore>(vk_.vkCreateSemaphore, vk_.vkDestroySemaphore, done, "bench"));
    keep(step_, vulkan::create_pipeline(*gpu_, cache_, step::info(), {}, nullptr));
    const rhi::RasterState raster{.color = {{.format = rhi::Format::rgba8_unorm}}};
    keep(mark_, vulkan::create_pipeline(*gpu_, cache_, mark::info(), {}, &raster));
    keep(sampler_, vulkan::create_sampler(*gpu_, {.magnification = rhi::FilterMode::nearest,
                                                  .minification = rhi::FilterMode::nearest,
                                                  .mip = rhi::FilterMode::nearest}));
    for (vulkan::Texture& picture : pictures_) keep(picture, texture(1, rhi::TextureUsage::sampled));
    keep(target_, texture(mark_side, rhi::TextureUsage::attachment));
    keep(transfer_texture_, texture(transfer_side, rhi::TextureUsage::sampled));
    for (vulkan::Buffer& items : items_) keep(items, buffer(step_items * sizeof(uint32_t), Memory::device));
    keep(corners_, buffer(2 * corners_stride, Memory::device));
    keep(transfer_buffer_, buffer(transfer_bytes, Memory::device));
    keep(upload_, buffer(transfer_bytes, Memory::upload));
    keep(readback_, buffer(transfer_bytes, Memory::readback));
    if (!keep.fine) return keep.fine;

    for (size_t i = 0; i < rhi::max_in_flight; ++i) {
        const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pools_[i].get(),
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
        if (VkResult result = vk_.vkAllocateCommandBuffers(gpu_->device(), &allocate, &command_buffers_[i]))
            return vulkan::fail(result, gpu_->info().name, "vkAllocateCommandBuffers");
    }
    for (int i = 0; i < 2; ++i) picture_views_[i] = view(pictures_[i], rhi::TextureUsage::sampled);
    target_view_ = view(target_, rhi::TextureUsage::attachment);

    const std::vector<uint32_t> items = first_items();
    const std::vector<std::byte> corners = corner_bytes();
    const VkDeviceSize corners_at = items.size() * sizeof(uint32_t), colors_at = corners_at + corners.size();
    std::byte* mapped = upload_.memory->mapped;
    std::memcpy(mapped, items.data(), corners_at);
    std::memcpy(mapped + corners_at, corners.data(), corners.size());
    std::memcpy(mapped + colors_at, texture_colors, sizeof texture_colors);
    return submitted([&] {
               const VkBufferCopy words{0, 0, corners_at}, points{corners_at, 0, corners.size()};
               for (int i = 0; i < 2; ++i) {
                   VkImage picture = pictures_[i].image();
                   VkBufferImageCopy texel = whole(1);
                   texel.bufferOffset = colors_at + VkDeviceSize(i) * 4;
                   vk_.vkCmdCopyBuffer(commands_, upload_.buffer.get(), items_[i].buffer.get(), 1, &words);
                   change_layout(picture, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
                   vk_.vkCmdCopyBufferToImage(commands_, upload_.buffer.get(), picture,
                                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &texel);
                   change_layout(picture, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                 VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
               }
               vk_.vkCmdCopyBuffer(commands_, upload_.buffer.get(), corners_.buffer.get(), 1, &points);
               change_layout(transfer_texture_.image(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
               order(VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                     VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
           })
        .map([](double) {});
}

VkImageView StraightVulkan::view(vulkan::Texture& texture, rhi::TextureUsage use) {
    const rhi::TextureView all{.dimension = rhi::Dimension::d2, .format = texture.desc().format};
    return texture.view(*gpu_, all, use).value_or(VkImageView(VK_NULL_HANDLE));
}

void StraightVulkan::push_bindings(const vulkan::Pipeline& pipeline,
                                   std::span<const VkWriteDescriptorSet> writes) const {
    vk_.vkCmdPushDescriptorSetKHR(commands_, pipeline.bind_point, pipeline.layout.get(), 0,
                                  uint32_t(writes.size()), writes.data());
}

VkWriteDescriptorSet write(uint32_t binding, const VkDescriptorBufferInfo& buffer) {
    return {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstBinding = binding,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pBufferInfo = &buffer};
}

VkWriteDescriptorSet write(uint32_t binding, const VkDescriptorImageInfo& image) {
    return {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstBinding = binding,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .pImageInfo = &image};
}

Result<double> StraightVulkan::dispatches(uint32_t count) {
    return submitted([&] {
        vk_.vkCmdBindPipeline(commands_, step_.bind_point, step_.pipeline.get());
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            order(VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                  VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                  VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
            const step::Push push = step_push(i);
            vk_.vkCmdPushConstants(commands_, step_.layout.get(), step_.stages, 0, sizeof push, &push);
            const VkDescriptorImageInfo picture{sampler_.get(), picture_views_[odd],
                                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
            const VkDescriptorBufferInfo source{items_[odd].buffer.get(), 0, step_items * sizeof(uint32_t)};
            const VkDescriptorBufferInfo target{items_[1 - odd].buffer.get(), 0,
                                                step_items * sizeof(uint32_t)};
            const VkWriteDescriptorSet writes[] = {write(0, picture), write(1, source), write(2, target)};
            push_bindings(step_, writes);
            vk_.vkCmdDispatch(commands_, 1, 1, 1);
        }
    });
}

Result<double> StraightVulkan::draws(uint32_t count) {
    return submitted([&] {
        change_layout(target_.image(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        const VkRenderingAttachmentInfo color{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                              .imageView = target_view_,
                                              .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                              .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                              .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
        const VkRect2D area{{0, 0}, {mark_side, mark_side}};
        const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                   .renderArea = area,
                                   .layerCount = 1,
                                   .colorAttachmentCount = 1,
                                   .pColorAttachments = &color};
        vk_.vkCmdBeginRendering(commands_, &info);
        const VkViewport viewport{0, 0, mark_side, mark_side, 0, 1};
        vk_.vkCmdSetViewport(commands_, 0, 1, &viewport);
        vk_.vkCmdSetScissor(commands_, 0, 1, &area);
        vk_.vkCmdBindPipeline(commands_, mark_.bind_point, mark_.pipeline.get());
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            const mark::Push push = mark_push(i);
            vk_.vkCmdPushConstants(commands_, mark_.layout.get(), mark_.stages, 0, sizeof push, &push);
            const VkDescriptorBufferInfo corners{corners_.buffer.get(), odd * corners_stride, corners_stride};
            const VkDescriptorImageInfo picture{sampler_.get(), picture_views_[odd],
                                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
            const VkWriteDescriptorSet writes[] = {write(0, corners), write(1, picture)};
            push_bindings(mark_, writes);
            vk_.vkCmdDraw(commands_, 3, 1, 0, 0);
        }
        vk_.vkCmdEndRendering(commands_);
    });
}

Result<std::vector<std::byte>> StraightVulkan::outcome() {
    constexpr VkDeviceSize words = step_items * sizeof(uint32_t),
                           texels = VkDeviceSize{mark_side} * mark_side * 4;
    return submitted([&] {
               order(VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT);
               const VkBufferCopy region{0, 0, words};
               vk_.vkCmdCopyBuffer(commands_, items_[0].buffer.get(), readback_.buffer.get(), 1, &region);
               change_layout(target_.image(), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
               VkBufferImageCopy picture = whole(mark_side);
               picture.bufferOffset = words;
               vk_.vkCmdCopyImageToBuffer(commands_, target_.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                          readback_.buffer.get(), 1, &picture);
               order(VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
           })
        .map([&](double) {
            const std::byte* mapped = readback_.memory->mapped;
            return std::vector(mapped, mapped + words + texels);
        });
}

Result<double> StraightVulkan::transfer(Transfer what) {
    const double start = wall_seconds();
    const bool upload = what == Transfer::buffer_upload || what == Transfer::texture_upload;
    if (upload) std::memcpy(upload_.memory->mapped, bytes_.data(), transfer_bytes);
    auto done = submitted([&] {
        const VkBufferCopy all{0, 0, transfer_bytes};
        const VkBufferImageCopy picture = whole(transfer_side);
        VkImage image = transfer_texture_.image();
        switch (what) {
            case Transfer::buffer_upload:
                vk_.vkCmdCopyBuffer(commands_, upload_.buffer.get(), transfer_buffer_.buffer.get(), 1, &all);
                break;
            case Transfer::texture_upload:
                vk_.vkCmdCopyBufferToImage(commands_, upload_.buffer.get(), image, VK_IMAGE_LAYOUT_GENERAL, 1,
                                           &picture);
                break;
            case Transfer::buffer_readback:
                vk_.vkCmdCopyBuffer(commands_, transfer_buffer_.buffer.get(), readback_.buffer.get(), 1,
                                    &all);
                break;
            case Transfer::texture_readback:
                vk_.vkCmdCopyImageToBuffer(commands_, image, VK_IMAGE_LAYOUT_GENERAL, readback_.buffer.get(),
                                           1, &picture);
                break;
        }
        order(VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
              VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
              VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    });
    if (!done) return done;
    if (!upload) std::memcpy(bytes_.data(), readback_.memory->mapped, transfer_bytes);
    return wall_seconds() - start;
}

}  // namespace

Result<std::unique_ptr<RhiWork>> work_straight_to_vulkan(const rhi::DeviceInfo& info) {
    auto gpu = vulkan::Gpu::create({.name = info.name}, nullptr);
    if (!gpu) return tl::unexpected(gpu.error());
    if (!(*gpu)->has_push_descriptors())
        return fail(ErrorKind::unsupported, info.name, "it has no push descriptors",
                    "measure a device with VK_KHR_push_descriptor");
    auto made = std::make_unique<StraightVulkan>(*std::move(gpu));
    return made->prepare().map([&]() -> std::unique_ptr<RhiWork> { return std::move(made); });
}

}  // namespace lumo::program
