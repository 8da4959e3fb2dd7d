#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "rhi/disk_cache.hpp"
#include "tests/support/full_disk.hpp"

namespace lumo::rhi {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

CacheKey key_of(std::string_view text) { return KeyBuilder().add(text).key(); }

/// Sets an environment variable, and gives it its old value back.
class Environment {
  public:
    Environment(const char* name, const char* value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old;
        set(value);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() { set(old_ ? old_->c_str() : nullptr); }

  private:
    void set(const char* value) {
        if (value != nullptr) {
            ::setenv(name_, value, 1);
        } else {
            ::unsetenv(name_);
        }
    }

    const char* name_;
    std::optional<std::string> old_;
};

class DiskCacheTest : public testing::Test {
  protected:
    static fs::path make_root() {
        std::string path = (fs::temp_directory_path() / "lumo-test-XXXXXX").string();
        return ::mkdtemp(path.data());
    }
    ~DiskCacheTest() override {
        std::error_code ignored;
        fs::permissions(root, fs::perms::owner_all, ignored);
        fs::remove_all(root, ignored);
    }

    std::vector<fs::path> files() const {
        std::vector<fs::path> paths;
        for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
        return paths;
    }

    uint64_t bytes_on_disk() const {
        uint64_t total = 0;
        for (const fs::path& path : files()) total += fs::file_size(path);
        return total;
    }

    static void age(const fs::path& path, std::chrono::hours by) {
        fs::last_write_time(path, fs::last_write_time(path) - by);
    }

    fs::path root = make_root();
    fs::path folder = root / "cache";
};

TEST(KeyBuilderTest, TellsApartWhatDiffers) {
    EXPECT_EQ(key_of("abc"), key_of("abc"));
    EXPECT_NE(key_of("abc"), key_of("abd"));
    EXPECT_NE(key_of("abc"), key_of(std::string_view("abc\0", 4)));
    EXPECT_NE(KeyBuilder().add("ab").add("c").key(), KeyBuilder().add("a").add("bc").key());
    EXPECT_NE(KeyBuilder().add("").key(), KeyBuilder().key());
    EXPECT_NE(KeyBuilder().add(uint64_t(1)).add(uint64_t(2)).key(),
              KeyBuilder().add(uint64_t(2)).add(uint64_t(1)).key());
}

TEST(KeyBuilderTest, EveryBitCounts) {
    std::vector<std::byte> bytes(41);
    const CacheKey zero = KeyBuilder().add(bytes).key();
    for (std::byte& byte : bytes) {
        for (int bit = 0; bit < 8; ++bit) {
            byte = std::byte(1 << bit);
            const CacheKey key = KeyBuilder().add(bytes).key();
            EXPECT_NE(key.high, zero.high);
            EXPECT_NE(key.low, zero.low);
        }
        byte = {};
    }
}

TEST_F(DiskCacheTest, GivesBackWhatWasPut) {
    const DiskCache cache(folder);
    EXPECT_FALSE(cache.get(key_of("a")));
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("first")));
    ASSERT_TRUE(cache.put(key_of("b"), bytes_of("")));
    EXPECT_EQ(cache.get(key_of("a")), bytes_of("first"));
    EXPECT_EQ(cache.get(key_of("b")), bytes_of(""));
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("second, and longer")));
    EXPECT_EQ(DiskCache(folder).get(key_of("a")), bytes_of("second, and longer"));
    EXPECT_EQ(files().size(), 2u);
}

TEST_F(DiskCacheTest, IsForItsUserOnly) {
    const auto mode = [&](const fs::path& path) {
        struct stat status {};
        EXPECT_EQ(::stat(path.c_str(), &status), 0);
        return status.st_mode & 0777;
    };
    const DiskCache cache(folder / "deep" / "lumo");
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("text")));
    EXPECT_EQ(mode(folder / "deep" / "lumo"), 0700u);

    fs::create_directory(root / "open");
    fs::permissions(root / "open", fs::perms::all);
    ASSERT_TRUE(DiskCache(root / "open").put(key_of("a"), bytes_of("text")));
    EXPECT_EQ(mode(root / "open"), 0700u);
    EXPECT_EQ(mode(*fs::directory_iterator(root / "open")) & 0077, 0u);
}

TEST_F(DiskCacheTest, IgnoresAndRemovesDamagedEntries) {
    const DiskCache cache(folder);
    const std::vector<std::byte> value = bytes_of("a value of some length");
    ASSERT_TRUE(cache.put(key_of("a"), value));
    const fs::path path = files().at(0);
    std::ifstream in(path, std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};

    const auto overwrite = [&](const std::string& bytes) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    };
    for (size_t size = 0; size < good.size(); ++size) {
        overwrite(good.substr(0, size));
        ASSERT_FALSE(cache.get(key_of("a"))) << "cut to " << size;
        EXPECT_FALSE(fs::exists(path));
    }
    for (size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = char(bad[i] ^ 0x10);
        overwrite(bad);
        ASSERT_FALSE(cache.get(key_of("a"))) << "byte " << i;
    }
    overwrite(good + "more");
    EXPECT_FALSE(cache.get(key_of("a")));
    overwrite(good);
    EXPECT_EQ(cache.get(key_of("a")), value) << "the bytes themselves are right";
    ASSERT_TRUE(cache.put(key_of("a"), value));
    EXPECT_EQ(cache.get(key_of("a")), value);
}

TEST_F(DiskCacheTest, DoesNotTakeAnotherKeysEntry) {
    const DiskCache cache(folder);
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("of a")));
    const fs::path of_a = files().at(0);
    ASSERT_TRUE(cache.put(key_of("b"), bytes_of("of b")));
    for (const fs::path& path : files()) {
        if (path != of_a) fs::copy_file(of_a, path, fs::copy_options::overwrite_existing);
    }
    EXPECT_FALSE(cache.get(key_of("b")));
    EXPECT_EQ(cache.get(key_of("a")), bytes_of("of a"));
}

TEST_F(DiskCacheTest, OpensOnlyRegularFiles) {
    const DiskCache cache(folder);
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("text")));
    const fs::path path = files().at(0);
    fs::rename(path, root / "moved");
    fs::create_symlink(root / "moved", path);
    EXPECT_FALSE(cache.get(key_of("a")));
    fs::remove(path);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_FALSE(cache.get(key_of("a"))) << "and does not wait for a writer";
}

TEST_F(DiskCacheTest, KeepsItsBoundByLeavingOutTheLeastRecentlyUsed) {
    const std::vector<std::byte> kilobyte(1000);
    const DiskCache cache(folder, 3500);
    ASSERT_TRUE(cache.put(key_of("oldest"), kilobyte));
    const fs::path oldest = files().at(0);
    age(oldest, std::chrono::hours(3));
    ASSERT_TRUE(cache.put(key_of("older"), kilobyte));
    for (const fs::path& path : files()) {
        if (path != oldest) age(path, std::chrono::hours(2));
    }
    ASSERT_TRUE(cache.get(key_of("oldest")));  // makes it the most recently used
    ASSERT_TRUE(cache.put(key_of("new"), kilobyte));
    ASSERT_TRUE(cache.put(key_of("newest"), kilobyte));
    EXPECT_LE(bytes_on_disk(), 3500u);
    EXPECT_FALSE(cache.get(key_of("older")));
    EXPECT_TRUE(cache.get(key_of("oldest")));
    EXPECT_TRUE(cache.get(key_of("new")));
    EXPECT_TRUE(cache.get(key_of("newest")));

    const auto put = cache.put(key_of("large"), std::vector<std::byte>(4000));
    ASSERT_FALSE(put);
    EXPECT_EQ(put.error().kind, ErrorKind::limit);
    EXPECT_TRUE(cache.get(key_of("newest")));
}

TEST_F(DiskCacheTest, SweepsUpWhatOthersLeftUnfinished) {
    const DiskCache cache(folder);
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("text")));
    const fs::path abandoned = folder / "0.entry.AAAAAA.part";
    const fs::path in_work = folder / "1.entry.AAAAAA.part";
    std::ofstream(abandoned) << "half";
    std::ofstream(in_work) << "half";
    age(abandoned, std::chrono::hours(2));
    ASSERT_TRUE(cache.put(key_of("b"), bytes_of("text")));
    EXPECT_FALSE(fs::exists(abandoned));
    EXPECT_TRUE(fs::exists(in_work));
}

TEST_F(DiskCacheTest, IsNoFailureWhereItCannotWrite) {
    const DiskCache none{fs::path()};
    EXPECT_FALSE(none.get(key_of("a")));
    EXPECT_EQ(none.put(key_of("a"), bytes_of("text")).error().kind, ErrorKind::io);

    std::ofstream(root / "file") << "in the way";
    for (const fs::path& path : {root / "file", root / "file" / "below"}) {
        const DiskCache cache(path);
        EXPECT_FALSE(cache.get(key_of("a")));
        const auto put = cache.put(key_of("a"), bytes_of("text"));
        ASSERT_FALSE(put);
        EXPECT_EQ(put.error().kind, ErrorKind::io);
        EXPECT_EQ(put.error().subject, path.string());
    }
    if (::geteuid() == 0) return;  // whom permissions do not stop
    fs::permissions(root, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_FALSE(DiskCache(folder).put(key_of("a"), bytes_of("text")));
}

TEST_F(DiskCacheTest, AFullDiskKeepsWhatIsThereAndTakesMoreWhenThereIsRoom) {
    const auto disk = testing_support::FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    const DiskCache cache(disk->folder() / "cache");
    const std::vector<std::byte> page(10'000, std::byte(7));
    ASSERT_TRUE(cache.put(key_of("a"), page));
    disk->fill();
    const auto put = cache.put(key_of("b"), page);
    ASSERT_FALSE(put);
    EXPECT_EQ(put.error().kind, ErrorKind::io);
    EXPECT_NE(put.error().message.find("No space left"), std::string::npos) << put.error().message;
    EXPECT_FALSE(cache.put(key_of("a"), std::vector<std::byte>(20'000)));
    EXPECT_EQ(cache.get(key_of("a")), page) << "replaced as a whole or not at all";
    EXPECT_FALSE(cache.get(key_of("b")));
    EXPECT_EQ(std::distance(fs::directory_iterator(cache.folder()), {}), 1) << "nothing unfinished stays";
    EXPECT_FALSE(DiskCache(disk->folder() / "new").put(key_of("a"), page)) << "not even a folder fits";
    disk->empty();
    ASSERT_TRUE(cache.put(key_of("b"), page));
    EXPECT_EQ(cache.get(key_of("b")), page);
}

/// Where a file ends early for another reason than a full disk.
TEST_F(DiskCacheTest, AFileThatMayNotGrowLeavesNothing) {
    const DiskCache cache(folder);
    ASSERT_TRUE(cache.put(key_of("a"), bytes_of("small")));
    rlimit old{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limited{1000, old.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limited), 0);
    const auto put = cache.put(key_of("b"), std::vector<std::byte>(5000));
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    ASSERT_FALSE(put);
    EXPECT_EQ(put.error().kind, ErrorKind::io);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
    EXPECT_FALSE(cache.get(key_of("b")));
    EXPECT_TRUE(cache.put(key_of("b"), std::vector<std::byte>(5000)));
}

TEST_F(DiskCacheTest, ManyWritersLeaveWholeEntries) {
    const DiskCache cache(folder);
    const std::vector<std::byte> values[] = {std::vector<std::byte>(50'000, std::byte(1)),
                                             std::vector<std::byte>(70'000, std::byte(2))};
    std::vector<std::thread> threads;
    for (const auto& value : values) {
        threads.emplace_back([&] {
            for (int i = 0; i < 50; ++i) EXPECT_TRUE(cache.put(key_of("a"), value));
        });
    }
    for (int i = 0; i < 100; ++i) {
        const auto value = cache.get(key_of("a"));
        ASSERT_TRUE(!value || *value == values[0] || *value == values[1]);
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(files().size(), 1u);
    EXPECT_TRUE(cache.get(key_of("a")));
}

TEST(DiskCacheOfUser, FollowsTheXdgRules) {
    const Environment home("HOME", "/home/somebody");
    {
        const Environment cache("XDG_CACHE_HOME", "/var/tmp/cache");
        EXPECT_EQ(DiskCache::of_user().folder(), "/var/tmp/cache/lumo");
    }
    for (const char* unusable : {"", "relative/path", static_cast<const char*>(nullptr)}) {
        const Environment cache("XDG_CACHE_HOME", unusable);
        EXPECT_EQ(DiskCache::of_user().folder(), "/home/somebody/.cache/lumo");
    }
    const Environment no_home("HOME", nullptr);
    const Environment no_cache("XDG_CACHE_HOME", nullptr);
    EXPECT_TRUE(DiskCache::of_user().folder().empty());
}

}  // namespace
}  // namespace lumo::rhi
