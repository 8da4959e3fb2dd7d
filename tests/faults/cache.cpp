// The caches on disk: whatever is in them, and wherever they cannot be, pipelines are made and are right.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "rhi/disk_cache.hpp"
#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/store_d2.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/full_disk.hpp"

namespace lumo::rhi {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;
using namespace shaders::test_rhi;
using testing::Each;
using testing::IsEmpty;

std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

struct CacheTest : testing::TestWithParam<Api> {
    static fs::path make_root() {
        std::string path = (fs::temp_directory_path() / "lumo-test-XXXXXX").string();
        return ::mkdtemp(path.data());
    }
    void SetUp() override {
        if (const char* old = std::getenv("XDG_CACHE_HOME")) old_ = old;
        use(root_);
        // Mesa's own elsewhere: it would be in the same place, and it misses a folder that goes away.
        ::setenv("MESA_SHADER_CACHE_DIR", (fs::temp_directory_path() / "lumo-test-mesa").c_str(), 1);
        if (!open_device(GetParam(), {.disk_cache = false}))
            GTEST_SKIP() << "no device for " << to_string(GetParam());
    }
    void TearDown() override {
        if (old_)
            ::setenv("XDG_CACHE_HOME", old_->c_str(), 1);
        else
            ::unsetenv("XDG_CACHE_HOME");
        fs::remove_all(root_);
    }
    void use(const fs::path& folder) { ::setenv("XDG_CACHE_HOME", folder.c_str(), 1); }

    /// A device makes its pipelines, which do what they should, and nothing is said.
    void expect_right_results() {
        auto opened = open_device(GetParam());
        ASSERT_TRUE(opened);
        {
            Device& device = *opened->device;
            const auto step = must(device.create_compute_pipeline<advance>());
            const auto store = must(device.create_compute_pipeline<store_d2>());
            Buffer values = must(device.create_buffer({.name = "values", .size = 256}));
            Texture picture = must(device.create_texture({.name = "picture",
                                                          .format = Format::rgba32_float,
                                                          .extent = {4, 4, 1},
                                                          .usage = TextureUsage::storage}));
            must(device.upload(values.slice(), bytes_of(std::vector<uint32_t>(64, 5))));
            Commands commands = device.begin();
            {
                Pass pass = commands.pass("both");
                pass.dispatch(step, {values.slice()}, {}, {1});
                pass.dispatch(store, {picture.mip<Dimension::d2>(0)}, {.size = {4, 4, 1}, .base = 9}, {1});
            }
            must(device.wait(device.submit(std::move(commands))));
            EXPECT_THAT(values_of<uint32_t>(must(device.download(values.slice()))), Each(16u));
            const auto texels = values_of<float>(must(device.download(picture, whole_mip(picture.desc()))));
            EXPECT_EQ(texels[0], 9);
            EXPECT_EQ(texels[4 * 15], 9 + 3 + 48);
        }
        opened->device.reset();
        for (const Message& message : opened->take_failures()) ADD_FAILURE() << message.id << message.text;
    }
    std::vector<fs::path> entries() const {
        std::vector<fs::path> paths;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(root_ / "lumo", none)) paths.push_back(entry.path());
        return paths;
    }
    /// Every entry becomes what `damage` makes of it, and the next device sees through it and replaces it.
    void expect_replaced(const std::function<std::string(std::string)>& damage) {
        std::vector<std::string> damaged;
        for (const fs::path& path : entries()) {
            damaged.push_back(damage(read(path)));
            write(path, damaged.back());
        }
        const auto paths = entries();
        ASSERT_FALSE(paths.empty());
        expect_right_results();
        for (size_t i = 0; i < paths.size(); ++i) {
            ASSERT_TRUE(fs::exists(paths[i])) << "rewritten";
            EXPECT_NE(read(paths[i]), damaged[i]) << "rewritten";
        }
        EXPECT_EQ(entries().size(), paths.size());
    }

    const fs::path root_ = make_root();

  private:
    std::optional<std::string> old_;
};
INSTANTIATE_TEST_SUITE_P(Device, CacheTest, both_apis, api_name);

TEST_P(CacheTest, IsWrittenAndReadAgain) {
    expect_right_results();
    const auto written = entries();
    ASSERT_FALSE(written.empty());
    std::vector<std::string> before;
    for (const fs::path& path : written) before.push_back(read(path));
    expect_right_results();
    EXPECT_EQ(entries(), written);
    for (size_t i = 0; i < written.size(); ++i) EXPECT_EQ(read(written[i]), before[i]) << "read, not remade";
}

TEST_P(CacheTest, DamagedEntriesAreReplaced) {
    expect_right_results();
    expect_replaced([](std::string) { return std::string(); });
    expect_replaced([](std::string entry) { return entry.substr(0, entry.size() / 2); });
    expect_replaced([](std::string entry) { return entry.substr(0, entry.size() - 1); });
    expect_replaced([](std::string entry) { return entry + "more"; });
    expect_replaced([](std::string entry) {
        entry[entry.size() / 2] = char(entry[entry.size() / 2] ^ 0x40);
        return entry;
    });
    expect_replaced([](std::string entry) {
        entry.back() = char(entry.back() ^ 1);
        return entry;
    });
    // The version of the entries' format follows the eight letters that begin it.
    expect_replaced([](std::string entry) {
        entry[8] = char(entry[8] + 1);
        return entry;
    });
    expect_replaced([](std::string entry) { return std::string(entry.size(), '\xff'); });
}

TEST_P(CacheTest, WhatIsWholeButOfAnotherDeviceIsReplaced) {
    expect_right_results();
    const DiskCache cache(root_ / "lumo");
    const auto replace_all = [&](const std::function<void(std::vector<std::byte>&)>& change) {
        for (const fs::path& path : entries()) {
            const std::string name = path.stem().string();
            const CacheKey key{std::stoull(name.substr(0, 16), nullptr, 16),
                               std::stoull(name.substr(16, 16), nullptr, 16)};
            auto bytes = cache.get(key);
            ASSERT_TRUE(bytes);
            change(*bytes);
            must(cache.put(key, *bytes));
        }
        expect_replaced([](std::string entry) { return entry; });
    };
    // OpenGL's binary format, or the length of Vulkan's header.
    replace_all([](std::vector<std::byte>& bytes) { bytes[0] ^= std::byte(0x5a); });
    // A driver's own check sum, or Vulkan's vendor, device and UUID.
    for (size_t byte : {4, 8, 12, 16, 31})
        replace_all([=](std::vector<std::byte>& bytes) { bytes[byte] ^= std::byte(0xff); });
    replace_all([](std::vector<std::byte>& bytes) { bytes.resize(3); });
}

TEST_P(CacheTest, AFullDiskIsNoFailure) {
    const auto disk = FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    use(disk->folder());
    disk->fill();
    expect_right_results();
    const fs::path folder = disk->folder() / "lumo";
    EXPECT_TRUE(!fs::exists(folder) || fs::is_empty(folder)) << "nothing unfinished stays";
    disk->empty();
    expect_right_results();
    EXPECT_FALSE(fs::is_empty(folder)) << "written when there is room";
}

TEST_P(CacheTest, AFolderThatCannotBeIsNoFailure) {
    write(root_ / "file", "in the way");
    for (const fs::path& folder : {root_ / "file", root_ / "file" / "below", fs::path("/proc/none")}) {
        use(folder);
        expect_right_results();
    }
    EXPECT_EQ(read(root_ / "file"), "in the way");
    EXPECT_THAT(entries(), IsEmpty());
}

}  // namespace
}  // namespace lumo::rhi
