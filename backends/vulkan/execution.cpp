#include "backends/vulkan/execution.hpp"

#include <algorithm>
#include <cmath>

namespace lumo::backends::vulkan {

namespace {

constexpr uint32_t passes_per_pool = 64;
constexpr uint64_t stamps_kept = 16;

}  // namespace

Result<std::unique_ptr<Executor>> Executor::create(const Gpu& gpu, Store& store) {
    std::unique_ptr<Executor> made(new Executor(gpu, store));
    const auto& vk = gpu.vk();
    VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                   .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    auto timeline =
        gpu.make<VkSemaphore>(vk.vkCreateSemaphore, vk.vkDestroySemaphore, semaphore, "submissions");
    if (!timeline) return tl::unexpected(timeline.error());
    made->timeline_ = std::move(*timeline);
    for (auto& frame : made->frames_) {
        VkCommandPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .queueFamilyIndex = gpu.queue_family()};
        auto pool =
            gpu.make<VkCommandPool>(vk.vkCreateCommandPool, vk.vkDestroyCommandPool, info, "submission");
        if (!pool) return tl::unexpected(pool.error());
        frame.pool = std::move(*pool);
        VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = frame.pool.get(),
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
        VkResult result = vk.vkAllocateCommandBuffers(gpu.device(), &allocate, &frame.commands);
        if (result != VK_SUCCESS) return fail(result, gpu.info().name, "vkAllocateCommandBuffers");
    }
    return made;
}

/// A host's other queues are not lumo's to wait for.
Executor::~Executor() {
    if (gpu_.is_adopted()) {
        (void)wait(submitted_);
    } else {
        vk_.vkDeviceWaitIdle(gpu_.device());
    }
}

/// A lost device stays lost, and nothing runs on it once that is known.
Result<void> Executor::check(VkResult result, std::string_view call) {
    if (lost_) return fail(VK_ERROR_DEVICE_LOST, gpu_.info().name, call);
    if (result == VK_SUCCESS) return {};
    if (result == VK_ERROR_DEVICE_LOST) {
        lost_ = true;
        vk_.vkQueueWaitIdle(gpu_.queue());
    }
    return fail(result, gpu_.info().name, call);
}

/// Submission `serial` will not run: the timeline goes past it once those before it are done.
Result<void> Executor::skip(uint64_t serial, Error why) {
    if (lost_) return tl::unexpected(std::move(why));
    VkSemaphoreSignalInfo info{
        .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, .semaphore = timeline_.get(), .value = serial};
    // A serial that will never be reached is as good as a lost device.
    if (!wait(serial - 1) || vk_.vkSignalSemaphore(gpu_.device(), &info) != VK_SUCCESS)
        return check(VK_ERROR_DEVICE_LOST, "vkSignalSemaphore");
    submitted_ = serial;
    return tl::unexpected(std::move(why));
}

Result<void> Executor::begin(uint64_t serial) {
    waits_.clear();
    signals_.clear();
    Frame& frame = frames_[serial % frames_.size()];
    if (frame.serial) {
        if (auto done = wait(frame.serial); !done) return done;
        read_stamps(frame);
    }
    std::erase_if(stamps_, [&](const auto& entry) { return entry.first + stamps_kept < serial; });
    frame.passes = 0;
    frame.sets.reset(gpu_);
    VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                  .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    auto begun =
        check(vk_.vkResetCommandPool(gpu_.device(), frame.pool.get(), 0), "vkResetCommandPool").and_then([&] {
            return check(vk_.vkBeginCommandBuffer(frame.commands, &info), "vkBeginCommandBuffer");
        });
    if (!begun) return skip(serial, begun.error());
    frame.serial = serial;
    open_ = &frame;
    return {};
}

Result<void> Executor::emit(const rhi::EmittedPass& pass) {
    Result<void> room;
    if (gpu_.timestamp_bits() > 0) room = make_room_for_stamps();
    const bool timed = gpu_.timestamp_bits() > 0 && open_->queries[open_->passes / passes_per_pool];
    const auto& debug = gpu_.instance().vk();
    std::string name(pass.name);
    VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = name.c_str()};
    if (debug.begin_label) debug.begin_label(open_->commands, &label);
    bool serialised = gpu_.info().timing == rhi::Timing::serialised;
    // Later passes begin where the one before them was ordered to its end.
    if (serialised && open_->passes == 0) order_everything();
    if (timed) stamp(0);
    // llvmpipe takes a stamp when it next flushes its draws: without this, after the pass's dispatches.
    if (serialised) order_everything();
    auto recorded = recorder(*open_).record(pass);
    if (serialised) order_everything();
    if (timed) stamp(1);
    if (debug.end_label) debug.end_label(open_->commands);
    ++open_->passes;
    return recorded ? room : recorded;
}

Recorder Executor::recorder(Frame& frame) {
    return {gpu_, store_, swapchain_, frame.serial % frames_.size(), frame.sets, frame.commands};
}

/// Without memory accesses, so that the pass's times add up and yet nothing becomes visible that the plan's
/// own barriers forgot: synchronization validation still finds that.
void Executor::order_everything() {
    VkMemoryBarrier2 all{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                         .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                         .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &all};
    vk_.vkCmdPipelineBarrier2(open_->commands, &info);
}

Result<void> Executor::make_room_for_stamps() {
    uint32_t pool = open_->passes / passes_per_pool;
    if (open_->passes % passes_per_pool != 0) return {};
    // Passes without a pool are not timed.
    if (pool == open_->queries.size()) open_->queries.emplace_back();
    if (!open_->queries[pool]) {
        VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = passes_per_pool * 2};
        auto made = gpu_.make<VkQueryPool>(vk_.vkCreateQueryPool, vk_.vkDestroyQueryPool, info, "pass times");
        if (!made) return tl::unexpected(made.error());
        open_->queries[pool] = std::move(*made);
    }
    vk_.vkResetQueryPool(gpu_.device(), open_->queries[pool].get(), 0, passes_per_pool * 2);
    return {};
}

void Executor::stamp(uint32_t which) {
    VkQueryPool pool = open_->queries[open_->passes / passes_per_pool].get();
    vk_.vkCmdWriteTimestamp2(open_->commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool,
                             open_->passes % passes_per_pool * 2 + which);
}

Result<void> Executor::wait_for(const rhi::NativeSync& sync) { return add(waits_, sync); }

Result<void> Executor::signal(const rhi::NativeSync& sync) { return add(signals_, sync); }

Result<void> Executor::add(std::vector<VkSemaphoreSubmitInfo>& semaphores, const rhi::NativeSync& sync) {
    if (!gpu_.is_adopted()) return rhi::not_adopted(gpu_.info().name);
    semaphores.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                          .semaphore = handle_of<VkSemaphore>(sync.object),
                          .value = sync.value,
                          .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
    return {};
}

Result<void> Executor::submit(std::span<const rhi::Barrier> hand_back) {
    Frame& frame = *std::exchange(open_, nullptr);
    if (!hand_back.empty()) {
        const rhi::EmittedPass barriers_alone{.barriers = {hand_back.begin(), hand_back.end()}};
        (void)recorder(frame).record(barriers_alone);
    }
    VkMemoryBarrier2 to_host{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                             .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                             .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                             .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                             .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &to_host};
    vk_.vkCmdPipelineBarrier2(frame.commands, &dependency);
    VkResult result = vk_.vkEndCommandBuffer(frame.commands);
    VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                       .commandBuffer = frame.commands};
    signals_.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                        .semaphore = timeline_.get(),
                        .value = frame.serial,
                        .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
    if (const auto window = swapchain_.semaphores()) {
        waits_.push_back(window->free);
        signals_.push_back(window->drawn);
    }
    VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                       .waitSemaphoreInfoCount = uint32_t(waits_.size()),
                       .pWaitSemaphoreInfos = waits_.data(),
                       .commandBufferInfoCount = result == VK_SUCCESS ? 1u : 0u,
                       .pCommandBufferInfos = &commands,
                       .signalSemaphoreInfoCount = uint32_t(signals_.size()),
                       .pSignalSemaphoreInfos = signals_.data()};
    if (result != VK_SUCCESS) frame.passes = 0;
    // Submitted even when recording failed, because its serial is waited for.
    if (auto taken = check(vk_.vkQueueSubmit2(gpu_.queue(), 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
        !taken) {
        swapchain_.drop();
        return skip(std::exchange(frame.serial, 0), taken.error());
    }
    submitted_ = frame.serial;
    const VkResult presented = swapchain_.present(result == VK_SUCCESS);
    if (presented == VK_ERROR_DEVICE_LOST) return check(presented, "vkQueuePresentKHR");
    return check(result, "vkEndCommandBuffer");
}

uint64_t Executor::completed() {
    uint64_t serial = 0;
    VkResult result = vk_.vkGetSemaphoreCounterValue(gpu_.device(), timeline_.get(), &serial);
    if (check(result, "vkGetSemaphoreCounterValue")) completed_ = serial;
    return lost_ ? UINT64_MAX : completed_;
}

Result<void> Executor::wait(uint64_t serial) {
    VkSemaphore semaphore = timeline_.get();
    VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                             .semaphoreCount = 1,
                             .pSemaphores = &semaphore,
                             .pValues = &serial};
    if (lost_) return check(VK_ERROR_DEVICE_LOST, "vkWaitSemaphores");
    VkResult result = vk_.vkWaitSemaphores(gpu_.device(), &info, UINT64_MAX);
    // Where there is no memory to wait for one submission, all are waited for.
    if (result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST) result = vk_.vkQueueWaitIdle(gpu_.queue());
    return check(result, "vkWaitSemaphores");
}

void Executor::read_stamps(Frame& frame) {
    std::vector<rhi::PassStamp>& stamps = stamps_[frame.serial];
    stamps.assign(frame.passes, {});
    frame.serial = 0;
    uint32_t bits = gpu_.timestamp_bits();
    if (bits == 0) return;
    uint64_t mask = bits >= 64 ? UINT64_MAX : (uint64_t(1) << bits) - 1;
    double period = gpu_.properties().limits.timestampPeriod;
    for (uint32_t first = 0; first < frame.passes; first += passes_per_pool) {
        if (!frame.queries[first / passes_per_pool]) continue;
        uint32_t passes = std::min(frame.passes - first, passes_per_pool);
        std::array<uint64_t, passes_per_pool * 2> ticks{};
        vk_.vkGetQueryPoolResults(gpu_.device(), frame.queries[first / passes_per_pool].get(), 0, passes * 2,
                                  sizeof ticks, ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
        for (uint32_t i = 0; i < passes; ++i) {
            uint64_t begin = ticks[i * 2] & mask;
            // The difference first: the counter may wrap, and a double holds no full 64 bits.
            uint64_t elapsed = (ticks[i * 2 + 1] - begin) & mask;
            auto begin_ns = uint64_t(double(begin) * period);
            stamps[first + i] = {begin_ns, begin_ns + uint64_t(std::llround(double(elapsed) * period))};
        }
    }
}

std::vector<rhi::PassStamp> Executor::stamps(uint64_t serial) {
    Frame& frame = frames_[serial % frames_.size()];
    if (frame.serial == serial && !lost_ && &frame != open_) read_stamps(frame);
    auto found = stamps_.find(serial);
    return found == stamps_.end() ? std::vector<rhi::PassStamp>() : found->second;
}

}  // namespace lumo::backends::vulkan
