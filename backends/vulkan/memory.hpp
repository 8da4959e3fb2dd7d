// Device memory, handed out from large blocks.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "backends/vulkan/gpu.hpp"
#include "rhi/resources.hpp"

namespace lumo::backends::vulkan {

struct MemoryBlock;

struct MemoryRange {
    MemoryBlock* block;
    uint64_t offset;
    uint64_t size;
    std::byte* mapped;  ///< null for memory that the host does not see
};

/// Blocks of 64 MiB per memory type, first fit. What is large, or what the driver prefers to have alone, gets
/// memory of its own. Buffers and images never share a block, so that no granularity between them matters.
class Allocator {
  public:
    struct Release {
        Allocator* allocator;
        void operator()(MemoryRange* range) const;
    };
    /// Memory given back with its owner. The allocator must outlive it.
    using Allocation = std::unique_ptr<MemoryRange, Release>;

    explicit Allocator(const Gpu& gpu);
    ~Allocator();
    Allocator(const Allocator&) = delete;
    Allocator& operator=(const Allocator&) = delete;

    /// Memory for one buffer or image, bound to it; the other is null. Upload and readback memory is coherent
    /// and stays mapped; readback memory is cached where the device has such. Errors: out_of_memory,
    /// unsupported.
    Result<Allocation> bind(VkBuffer buffer, VkImage image, rhi::Memory where, const std::string& name);

  private:
    struct Request;
    Result<Allocation> allocate(const Request& request);
    Result<Allocation> allocate(const Request& request, uint32_t type);

    const Gpu& gpu_;
    VkPhysicalDeviceMemoryProperties properties_{};
    uint64_t max_allocation_ = 0;
    std::vector<std::unique_ptr<MemoryBlock>> blocks_;
};
using Allocation = Allocator::Allocation;

}  // namespace lumo::backends::vulkan
