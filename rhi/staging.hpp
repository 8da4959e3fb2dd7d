// Host memory on its way to the device and back.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "rhi/resource_table.hpp"

namespace lumo::rhi {

/// Upload memory for one submission at a time: blocks that are used again once the device has read them.
/// Serves uploads and transient uniforms alike.
class UploadRing {
  public:
    static constexpr uint64_t block_bytes = uint64_t{16} << 20;

    UploadRing(ResourceTable& resources, Backend& backend) : resources_(resources), backend_(backend) {}

    /// A copy of `bytes` that the device may read in submission `serial`. Errors: out_of_memory.
    Result<BufferSlice> put(std::span<const std::byte> bytes, uint64_t alignment, uint64_t serial);
    /// Whether a slice that was put is of submission `serial`, and not of one before it.
    bool holds(const BufferSlice& slice, uint64_t serial) const;

  private:
    struct Block {
        BufferHandle buffer;
        uint64_t used = 0;
        uint64_t serial = 0;  ///< the last that reads it
        uint64_t first = 0;   ///< where that one's bytes begin
    };
    Result<size_t> block_for(uint64_t bytes, uint64_t alignment);

    ResourceTable& resources_;
    Backend& backend_;
    std::vector<Block> blocks_;
    size_t current_ = 0;
};

/// Buffers that the device writes and the host reads, by ticket.
class ReadbackPool {
  public:
    explicit ReadbackPool(ResourceTable& resources) : resources_(resources) {}

    struct Ticket {
        BufferSlice slice;
        uint64_t serial = 0;
        std::optional<Error> failure = {};  ///< of the submission, instead of the bytes
    };

    /// Memory for `size` bytes that submission `serial` writes. Errors: out_of_memory.
    Result<Readback> open(uint64_t size, uint64_t serial);
    /// Null when there is no such ticket.
    const Ticket* find(Readback readback) const;
    /// The bytes of a ticket whose submission is done, or its failure; the ticket is gone then.
    Result<std::vector<std::byte>> take(Readback readback);
    /// Gives back the memory of a submission's tickets, which the error takes the place of.
    void fail(uint64_t serial, const Error& error);

  private:
    static constexpr uint64_t kept_bytes = uint64_t{64} << 20;  ///< of idle buffers

    ResourceTable& resources_;
    uint64_t last_id_ = 0;
    std::map<uint64_t, Ticket> tickets_;
    std::vector<BufferHandle> idle_;
};

}  // namespace lumo::rhi
