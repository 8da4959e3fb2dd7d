#include "rhi/staging.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace lumo::rhi {
namespace {

constexpr uint64_t align_up(uint64_t value, uint64_t alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

}  // namespace

Result<size_t> UploadRing::block_for(uint64_t bytes, uint64_t alignment) {
    const auto fits = [&](const Block& block) {
        return align_up(block.used, alignment) + bytes <= resources_.find(block.buffer)->desc.size;
    };
    if (current_ < blocks_.size() && fits(blocks_[current_])) return current_;

    // What the device has read is empty again; of that, one block is enough to go on with.
    const uint64_t completed = backend_.completed();
    bool kept = false;
    std::erase_if(blocks_, [&](Block& block) {
        if (block.serial > completed) return false;
        block.used = 0;
        const bool keep = !kept && resources_.find(block.buffer)->desc.size == block_bytes;
        kept = kept || keep;
        if (!keep) resources_.release(block.buffer, block.serial);
        return !keep;
    });
    const auto found = std::ranges::find_if(blocks_, fits);
    if (found != blocks_.end()) return size_t(found - blocks_.begin());

    auto made = resources_.create({.name = "staging",
                                   .size = std::max(bytes, block_bytes),
                                   .usage = BufferUsage::uniform,
                                   .memory = Memory::upload},
                                  true);
    if (!made) return tl::unexpected(made.error());
    blocks_.push_back({.buffer = *made});
    return blocks_.size() - 1;
}

Result<BufferSlice> UploadRing::put(std::span<const std::byte> bytes, uint64_t alignment, uint64_t serial) {
    // A block that the device has read is begun anew long before its end, so that little memory is touched; and
    // seldom, so that uniforms of an earlier submission are known by their place.
    if (current_ < blocks_.size()) {
        Block& last = blocks_[current_];
        const bool long_enough = last.used > block_bytes / 16 && last.serial < serial;
        if (long_enough && last.serial <= backend_.completed()) last.used = 0;
    }
    auto index = block_for(bytes.size(), alignment);
    if (!index) return tl::unexpected(index.error());
    current_ = *index;
    Block& block = blocks_[current_];
    const uint64_t offset = align_up(block.used, alignment);
    if (block.serial != serial) block.first = offset;
    block.used = offset + bytes.size();
    block.serial = serial;
    std::memcpy(resources_.find(block.buffer)->mapped + offset, bytes.data(), bytes.size());
    return BufferSlice{block.buffer, offset, bytes.size()};
}

bool UploadRing::holds(const BufferSlice& slice, uint64_t serial) const {
    return std::ranges::any_of(blocks_, [&](const Block& block) {
        return block.buffer == slice.buffer && block.serial == serial && slice.offset >= block.first;
    });
}

Result<Readback> ReadbackPool::open(uint64_t size, uint64_t serial) {
    // The smallest idle buffer that holds it, unless that would waste most of it.
    const uint64_t rounded = align_up(size, 4096);
    auto best = idle_.end();
    const auto size_of = [&](BufferHandle buffer) { return resources_.find(buffer)->desc.size; };
    for (auto it = idle_.begin(); it != idle_.end(); ++it)
        if (size_of(*it) >= size && size_of(*it) / 4 <= rounded &&
            (best == idle_.end() || size_of(*it) < size_of(*best)))
            best = it;
    BufferHandle buffer;
    if (best != idle_.end()) {
        buffer = *best;
        idle_.erase(best);
    } else {
        auto made = resources_.create(
            {.name = "readback", .size = rounded, .usage = BufferUsage::none, .memory = Memory::readback},
            true);
        if (!made) return tl::unexpected(made.error());
        buffer = *made;
    }
    tickets_[++last_id_] = {.slice = {buffer, 0, size}, .serial = serial};
    return Readback{last_id_};
}

const ReadbackPool::Ticket* ReadbackPool::find(Readback readback) const {
    const auto found = tickets_.find(readback.id);
    return found == tickets_.end() ? nullptr : &found->second;
}

void ReadbackPool::fail(uint64_t serial, const Error& error) {
    for (auto& [id, ticket] : tickets_) {
        if (ticket.serial != serial) continue;
        resources_.release(std::exchange(ticket.slice, {}).buffer, serial);
        ticket.failure = error;
    }
}

Result<std::vector<std::byte>> ReadbackPool::take(Readback readback) {
    const auto node = tickets_.extract(readback.id);
    const auto& [slice, serial, failure] = node.mapped();
    if (failure) return tl::unexpected(*failure);
    const std::byte* mapped = resources_.find(slice.buffer)->mapped;
    std::vector<std::byte> bytes(mapped, mapped + slice.size);

    idle_.push_back(slice.buffer);
    uint64_t kept = 0;
    for (BufferHandle buffer : idle_) kept += resources_.find(buffer)->desc.size;
    while (kept > kept_bytes) {
        kept -= resources_.find(idle_.front())->desc.size;
        resources_.release(idle_.front(), serial);
        idle_.erase(idle_.begin());
    }
    return bytes;
}

}  // namespace lumo::rhi
