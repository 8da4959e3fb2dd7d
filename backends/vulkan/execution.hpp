// Submissions in flight: command buffers, the timeline that counts them, and the time that passes took.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "backends/vulkan/recording.hpp"

namespace lumo::backends::vulkan {

/// The part of rhi::Backend that runs work.
class Executor {
  public:
    static Result<std::unique_ptr<Executor>> create(const Gpu& gpu, Store& store);
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    Result<void> begin(uint64_t serial);
    Result<void> emit(const rhi::EmittedPass& pass);
    Result<void> submit(std::span<const rhi::Barrier> hand_back);
    /// Of the open submission; semaphores of a host.
    Result<void> wait_for(const rhi::NativeSync& sync);
    Result<void> signal(const rhi::NativeSync& sync);
    uint64_t completed();
    Result<void> wait(uint64_t serial);
    std::vector<rhi::PassStamp> stamps(uint64_t serial);

  private:
    /// What one submission in flight needs for itself.
    struct Frame {
        Unique<VkCommandPool> pool;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        DescriptorSets sets;
        std::vector<Unique<VkQueryPool>>
            queries;  ///< of passes_per_pool passes each; empty ones could not be made
        uint32_t passes = 0;
        uint64_t serial = 0;  ///< 0: not used since its stamps were read
    };

    Executor(const Gpu& gpu, Store& store) : gpu_(gpu), vk_(gpu.vk()), store_(store), swapchain_(gpu) {}
    Result<void> check(VkResult result, std::string_view call);
    Result<void> make_room_for_stamps();
    Result<void> skip(uint64_t serial, Error error);
    Result<void> add(std::vector<VkSemaphoreSubmitInfo>& semaphores, const rhi::NativeSync& sync);
    Recorder recorder(Frame& frame);
    void stamp(uint32_t which);
    void order_everything();
    void read_stamps(Frame& frame);

    const Gpu& gpu_;
    const DeviceTable& vk_;
    Store& store_;
    Swapchain swapchain_;
    Unique<VkSemaphore> timeline_;
    std::array<Frame, rhi::max_in_flight> frames_;
    Frame* open_ = nullptr;
    std::vector<VkSemaphoreSubmitInfo> waits_;    ///< of the open submission, for the host's
    std::vector<VkSemaphoreSubmitInfo> signals_;  ///< likewise
    bool lost_ = false;
    uint64_t completed_ = 0;  ///< as last seen
    uint64_t submitted_ = 0;  ///< the last that the queue took
    std::map<uint64_t, std::vector<rhi::PassStamp>> stamps_;
};

}  // namespace lumo::backends::vulkan
