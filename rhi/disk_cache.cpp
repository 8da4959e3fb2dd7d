#include "rhi/disk_cache.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace lumo::rhi {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view entry_suffix = ".entry";
constexpr std::string_view unfinished_suffix = ".part";

/// What precedes the bytes of an entry.
struct Header {
    std::array<char, 8> magic{'l', 'u', 'm', 'o', 'c', 'a', 'c', 'h'};
    uint64_t version = 1;
    CacheKey key;
    uint64_t size = 0;
    CacheKey checksum;

    bool operator==(const Header&) const = default;
};
static_assert(std::has_unique_object_representations_v<Header>);

Header header_of(const CacheKey& key, std::span<const std::byte> bytes) {
    return {.key = key, .size = bytes.size(), .checksum = KeyBuilder().add(bytes).key()};
}

class File {
  public:
    explicit File(int descriptor) : descriptor_(descriptor) {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() { close(); }

    explicit operator bool() const { return descriptor_ >= 0; }
    int get() const { return descriptor_; }

    /// False if the system reports only now that something was not written.
    bool close() {
        const int descriptor = std::exchange(descriptor_, -1);
        return descriptor < 0 || ::close(descriptor) == 0;
    }

    bool read_all(void* to, size_t size) const {
        auto* next = static_cast<std::byte*>(to);
        while (size > 0) {
            const ssize_t count = ::read(descriptor_, next, size);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return false;
            next += count;
            size -= size_t(count);
        }
        return true;
    }

    bool write_all(const void* from, size_t size) const {
        const auto* next = static_cast<const std::byte*>(from);
        while (size > 0) {
            const ssize_t count = ::write(descriptor_, next, size);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return false;
            next += count;
            size -= size_t(count);
        }
        return true;
    }

  private:
    int descriptor_;
};

fs::path entry_path(const fs::path& folder, const CacheKey& key) {
    return folder / fmt::format("{:016x}{:016x}{}", key.high, key.low, entry_suffix);
}

tl::unexpected<Error> io_error(const fs::path& path, std::string_view what) {
    return fail(ErrorKind::io, path.string(), fmt::format("{}: {}", what, std::strerror(errno)),
                "the disk cache goes unused; set XDG_CACHE_HOME to a folder that can be written");
}

/// A folder that nobody else can put entries into, since drivers trust what is in them.
Result<void> make_private_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder.parent_path(), error);
    if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
        return io_error(folder, "cannot make the folder");
    struct stat status {};
    if (::stat(folder.c_str(), &status) != 0) return io_error(folder, "cannot read the folder");
    if (!S_ISDIR(status.st_mode) || status.st_uid != ::geteuid()) {
        return fail(ErrorKind::io, folder.string(), "not a folder of this user",
                    "the disk cache goes unused");
    }
    if ((status.st_mode & 0077) != 0 && ::chmod(folder.c_str(), 0700) != 0) {
        return io_error(folder, "cannot take away the access of others");
    }
    return {};
}

struct Entry {
    fs::path path;
    fs::file_time_type used;
    uint64_t size;
};

void evict(const fs::path& folder, uint64_t max_bytes) {
    std::error_code error;
    std::vector<Entry> entries;
    uint64_t total = 0;
    const fs::file_time_type abandoned = fs::file_time_type::clock::now() - std::chrono::hours(1);
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code ignored;
        const Entry entry{it->path(), it->last_write_time(ignored), it->file_size(ignored)};
        if (ignored) continue;
        if (entry.path.extension() == entry_suffix) {
            total += entry.size;
            entries.push_back(entry);
        } else if (entry.path.extension() == unfinished_suffix && entry.used < abandoned) {
            fs::remove(entry.path, ignored);
        }
    }
    std::ranges::sort(entries, {}, &Entry::used);
    for (const Entry& entry : entries) {
        if (total <= max_bytes) break;
        fs::remove(entry.path, error);
        total -= entry.size;
    }
}

}  // namespace

void KeyBuilder::mix(uint64_t word) {
    // Two lanes, each of which multiplies by an odd constant and folds the high bits down (the finalizer of
    // SplitMix64); the second sees the first, so that the lanes do not fail together.
    const auto scramble = [](uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
        x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
        return x ^ (x >> 31);
    };
    a_ = scramble(a_ ^ word) + 0x9e3779b97f4a7c15;
    b_ = scramble(std::rotl(b_, 23) ^ (word * 0xd6e8feb86659fd93) ^ a_);
}

KeyBuilder& KeyBuilder::add(std::span<const std::byte> bytes) {
    mix(bytes.size());
    while (!bytes.empty()) {
        uint64_t word = 0;
        const size_t count = std::min(bytes.size(), sizeof word);
        std::memcpy(&word, bytes.data(), count);
        mix(word);
        bytes = bytes.subspan(count);
    }
    return *this;
}

KeyBuilder& KeyBuilder::add(std::string_view text) { return add(std::as_bytes(std::span(text))); }

KeyBuilder& KeyBuilder::add(uint64_t number) {
    mix(number);
    return *this;
}

CacheKey KeyBuilder::key() const { return {a_, b_}; }

DiskCache DiskCache::of_user() {
    const auto absolute = [](const char* variable) {
        const char* value = std::getenv(variable);
        const fs::path path = value != nullptr ? value : "";
        return path.is_absolute() ? path : fs::path();
    };
    if (const fs::path cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return DiskCache(cache / "lumo");
    if (const fs::path home = absolute("HOME"); !home.empty()) return DiskCache(home / ".cache" / "lumo");
    return DiskCache({});
}

DiskCache::DiskCache(fs::path folder, uint64_t max_bytes)
    : folder_(std::move(folder)), max_bytes_(max_bytes) {}

std::optional<std::vector<std::byte>> DiskCache::get(const CacheKey& key) const {
    if (folder_.empty()) return std::nullopt;
    const fs::path path = entry_path(folder_, key);
    const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    struct stat status {};
    if (!file || ::fstat(file.get(), &status) != 0) return std::nullopt;

    Header header;
    std::vector<std::byte> bytes;
    const auto read_whole = [&] {
        const auto file_size = uint64_t(status.st_size);
        if (!S_ISREG(status.st_mode) || file_size < sizeof header || file_size - sizeof header > max_bytes_ ||
            !file.read_all(&header, sizeof header) || header.size != file_size - sizeof header) {
            return false;
        }
        bytes.resize(header.size);
        return file.read_all(bytes.data(), bytes.size()) && header == header_of(key, bytes);
    };
    if (!read_whole()) {
        ::unlink(path.c_str());
        return std::nullopt;
    }
    ::futimens(file.get(), nullptr);  // the least recently used entries go first
    return bytes;
}

Result<void> DiskCache::put(const CacheKey& key, std::span<const std::byte> bytes) const {
    if (folder_.empty()) {
        return fail(ErrorKind::io, "disk cache", "there is no folder for it", "set XDG_CACHE_HOME or HOME");
    }
    const Header header = header_of(key, bytes);
    if (bytes.size() + sizeof header > max_bytes_) {
        return fail(
            ErrorKind::limit, "disk cache",
            fmt::format("an entry of {} bytes is above the bound of {} for all", bytes.size(), max_bytes_));
    }
    if (Result<void> made = make_private_folder(folder_); !made) return made;

    std::string part = entry_path(folder_, key).string() + ".XXXXXX" + std::string(unfinished_suffix);
    File file(::mkostemps(part.data(), int(unfinished_suffix.size()), O_CLOEXEC));
    if (!file) return io_error(part, "cannot make the file");
    // No fsync: an entry that a power cut tears fails its checksum.
    if (!file.write_all(&header, sizeof header) || !file.write_all(bytes.data(), bytes.size()) ||
        !file.close() || ::rename(part.c_str(), entry_path(folder_, key).c_str()) != 0) {
        const auto error = io_error(part, "cannot write the file");
        ::unlink(part.c_str());
        return error;
    }
    evict(folder_, max_bytes_);
    return {};
}

}  // namespace lumo::rhi
