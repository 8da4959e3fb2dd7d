// Memory for what a pass records.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace lumo::rhi {

/// Hands out copies of values, which lie still until all are taken back at once. Its own memory is kept for the
/// next.
class Arena {
  public:
    template <class T>
    requires std::is_trivially_copyable_v<T> std::span<const T> copy(std::span<const T> values) {
        if (values.empty()) return {};
        std::byte* place = allocate(values.size_bytes());
        std::memcpy(place, values.data(), values.size_bytes());
        return {reinterpret_cast<const T*>(place), values.size()};
    }
    void clear() { block_ = used_ = 0; }

  private:
    static constexpr size_t block_bytes = size_t{64} << 10;
    static constexpr size_t alignment = alignof(std::max_align_t);
    struct Block {
        std::unique_ptr<std::byte[]> bytes;
        size_t size;
    };

    std::byte* allocate(size_t size) {
        while (block_ < blocks_.size() && used_ + size > blocks_[block_].size) {
            ++block_;
            used_ = 0;
        }
        if (block_ == blocks_.size()) {
            const size_t fitting = std::max(size, block_bytes);
            blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(fitting), fitting});
        }
        std::byte* place = blocks_[block_].bytes.get() + used_;
        used_ += (size + alignment - 1) / alignment * alignment;
        return place;
    }

    std::vector<Block> blocks_;
    size_t block_ = 0;  ///< the one that is being filled
    size_t used_ = 0;   ///< of it
};

}  // namespace lumo::rhi
