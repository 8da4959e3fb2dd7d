// A disk without room, of a test's own.
#pragma once

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <sched.h>
#include <string>
#include <sys/mount.h>
#include <unistd.h>

namespace lumo::testing_support {

/// A small file system in a folder of its own, seen by this process and its children alone.
class FullDisk {
  public:
    /// None where this process may not mount file systems.
    static std::unique_ptr<FullDisk> mount() {
        std::string folder = (std::filesystem::temp_directory_path() / "lumo-disk-XXXXXX").string();
        if (!::mkdtemp(folder.data())) return nullptr;
        const bool apart = ::unshare(CLONE_NEWNS) == 0 &&
                           ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                           ::mount("none", folder.c_str(), "tmpfs", 0, "size=1m") == 0;
        if (apart) return std::unique_ptr<FullDisk>(new FullDisk(folder));
        ::rmdir(folder.c_str());
        return nullptr;
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk() {
        ::umount2(folder_.c_str(), MNT_DETACH);
        ::rmdir(folder_.c_str());
    }

    const std::filesystem::path& folder() const { return folder_; }

    /// Leaves no room at all.
    void fill() const {
        const int file = ::open(filler().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        const std::string page(4096, '\0');
        while (::write(file, page.data(), page.size()) > 0) {
        }
        ::close(file);
    }
    /// Makes the room free again.
    void empty() const { std::filesystem::remove(filler()); }

  private:
    explicit FullDisk(std::filesystem::path folder) : folder_(std::move(folder)) {}
    std::filesystem::path filler() const { return folder_ / "filler"; }

    std::filesystem::path folder_;
};

}  // namespace lumo::testing_support
