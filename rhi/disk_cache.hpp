// A folder of results that cost more to make than to read: compiled shaders, drivers' pipeline caches.
// Nothing in it is trusted, and nothing depends on it: an entry that is not exactly what was put is as good
// as absent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::rhi {

/// 128 bits that name an entry. Two different entries get the same one by chance only with probability
/// 2^-128.
struct CacheKey {
    uint64_t high = 0;
    uint64_t low = 0;

    bool operator==(const CacheKey&) const = default;
};

/// Makes a key of all that a result depends on. The lengths of strings and arrays count, so that ("ab", "c")
/// and
/// ("a", "bc") differ. Not for hostile input: whoever can choose what is hashed can make keys collide.
class KeyBuilder {
  public:
    KeyBuilder& add(std::span<const std::byte> bytes);
    KeyBuilder& add(std::string_view text);
    KeyBuilder& add(uint64_t number);

    CacheKey key() const;

  private:
    void mix(uint64_t word);

    uint64_t a_ = 0x243f6a8885a308d3;
    uint64_t b_ = 0x13198a2e03707344;
};

/// Entries as files of one folder that only its user can read. Any number of processes may use the same
/// folder: an entry is written under another name and then renamed.
class DiskCache {
  public:
    static constexpr uint64_t default_max_bytes = uint64_t(256) << 20;

    /// $XDG_CACHE_HOME/lumo, or ~/.cache/lumo where that is unset, empty or not absolute; with neither, a
    /// cache that holds nothing.
    static DiskCache of_user();

    /// The folder is made by the first put. An empty path makes a cache that holds nothing.
    explicit DiskCache(std::filesystem::path folder, uint64_t max_bytes = default_max_bytes);

    const std::filesystem::path& folder() const { return folder_; }

    /// What was put under the key. Nothing if it is absent, damaged (it is then removed) or cannot be read.
    std::optional<std::vector<std::byte>> get(const CacheKey& key) const;

    /// Replaces what is under the key, then removes the least recently used entries until all of them
    /// together take at most max_bytes. Error: io, which a caller may log and otherwise ignore; limit for an
    /// entry above max_bytes.
    Result<void> put(const CacheKey& key, std::span<const std::byte> bytes) const;

  private:
    std::filesystem::path folder_;
    uint64_t max_bytes_;
};

}  // namespace lumo::rhi
