// Use over a long time: frames that make, use and destroy resources of random kinds and sizes, each with the
// right result, while neither memory nor the number of objects grows.
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <glm/vec4.hpp>
#include <random>
#include <unistd.h>

#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/faults.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using testing::Each;

constexpr int settled_after = 500;  ///< frames in which caches fill
constexpr int frames_per_look = 100;
constexpr uint64_t resident_slack = uint64_t{2} << 20;  ///< bytes that an allocator may keep apart

#ifdef __SANITIZE_ADDRESS__
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

/// What may grow.
struct Held {
    uint64_t device_bytes = 0;  ///< by the device's own report
    size_t device_entries = 0;
    int64_t objects = 0;  ///< of the API
    uint64_t resident_bytes = 0;

    std::string words() const {
        return fmt::format("{} bytes in {} resources, {} objects, {} KiB resident", device_bytes,
                           device_entries, objects, resident_bytes >> 10);
    }
};

uint64_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    uint64_t pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * uint64_t(::sysconf(_SC_PAGESIZE));
}

class Soak {
  public:
    explicit Soak(Device& device)
        : device_(device),
          step_(must(device.create_compute_pipeline<advance>())),
          sample_(make_sample()),
          draw_(make_draw()) {}

    void frame() {
        ++frame_;
        if (frame_ % 64 == 0) sample_ = make_sample();
        if (frame_ % 83 == 0) draw_ = make_draw();
        if (frame_ % 97 == 0) step_ = must(device_.create_compute_pipeline<advance>());
        replace(buffers_, 12, [&] { return make_buffer(); });
        replace(textures_, 8, [&] { return make_texture(); });

        Commands commands = device_.begin();
        std::vector<Readback> reads;
        const auto start = uint32_t(random_());
        {
            Pass pass = commands.pass("work");
            Buffer& values = any(buffers_);
            const uint64_t used = std::min<uint64_t>(values.size() / 4 * 4, 4096);
            const uint32_t steps = below(3);
            if (below(2))
                pass.upload(values.slice(0, used), bytes_of(std::vector<uint32_t>(used / 4, start)));
            else
                pass.fill(values.slice(0, used), start);
            for (uint32_t i = 0; i < steps; ++i)
                pass.dispatch(step_, {values.slice(0, used)}, {}, {groups_for(uint32_t(used / 4), 64)});
            expected_ = start;
            for (uint32_t i = 0; i < steps; ++i) expected_ = expected_ * 3 + 1;
            // A buffer of its own, gone before the device is done with it.
            Buffer passing = make_buffer(used);
            pass.copy(values.slice(0, used), passing.slice(0, used));
            reads.push_back(pass.read(passing.slice(0, used)));
        }
        sample_a_view(commands);
        draw(commands);
        const Submission submission = device_.submit(std::move(commands));
        if (below(4) == 0) textures_.erase(textures_.begin() + below(uint32_t(textures_.size())));
        EXPECT_THAT(values_of<uint32_t>(must(device_.take(reads[0]))), Each(expected_)) << "frame " << frame_;
        if (below(2)) {
            EXPECT_FALSE(device_.pass_times(submission).empty());
        }
    }

    /// What is held when nothing is in use: the caches alone.
    Held look() {
        buffers_.clear();
        textures_.clear();
        for (int i = 0; i < 3; ++i) must(device_.wait(device_.submit(device_.begin())));
        Held held;
        for (const MemoryEntry& entry : device_.memory()) {
            held.device_bytes += entry.bytes;
            ++held.device_entries;
        }
        for (const auto& [kind, number] : faults().live()) held.objects += number;
        held.resident_bytes = resident_bytes();
        return held;
    }

  private:
    uint32_t below(uint32_t limit) { return uint32_t(random_() % limit); }
    template <class T>
    T& any(std::vector<T>& all) {
        return all[below(uint32_t(all.size()))];
    }
    /// Makes a few, lets a few go, keeps between one and `most`.
    template <class T, class Make>
    void replace(std::vector<T>& all, uint32_t most, Make make) {
        for (uint32_t i = below(3); i > 0 && all.size() > 1; --i)
            all.erase(all.begin() + below(uint32_t(all.size())));
        for (uint32_t i = 1 + below(3); i > 0 && all.size() < most; --i) all.push_back(make());
        if (all.empty()) all.push_back(make());
    }

    RasterPipeline<pull> make_draw() {
        return must(device_.create_raster_pipeline<pull>({.color = {{.format = Format::rgba8_unorm}}}));
    }
    ComputePipeline<sample_d2> make_sample() { return must(device_.create_compute_pipeline<sample_d2>()); }

    Buffer make_buffer(uint64_t at_least = 64) {
        constexpr Memory memories[] = {Memory::device, Memory::device, Memory::upload, Memory::readback};
        const uint64_t size = at_least + below(1u << (6 + below(11)));
        return must(device_.create_buffer({.name = "random", .size = size, .memory = memories[below(4)]}));
    }

    Texture make_texture() {
        constexpr Format formats[] = {Format::rgba8_unorm, Format::r32_uint, Format::rgba16_float,
                                      Format::rgba32_float, Format::r8_unorm};
        constexpr Dimension shapes[] = {d1, d2, d2_array, d3, cube};
        const Dimension shape = shapes[below(5)];
        TextureDesc desc{.name = "random", .dimension = shape, .format = formats[below(5)]};
        const uint32_t side = 1u << below(7);
        desc.extent = {side, shape == d1 ? 1 : side, shape == d3 ? 1u << below(4) : 1};
        if (shape == d2 && below(2)) desc.extent.height = 1 + below(64);
        desc.layers = shape == cube ? 6 : shape == d2_array ? 1 + below(4) : 1;
        desc.mips = 1 + below(full_mips(desc.extent));
        return must(device_.create_texture(desc));
    }

    /// A texture of its own, through a view of one mip and a sampler of its own.
    void sample_a_view(Commands& commands) {
        Texture picture = must(device_.create_texture({.name = "sampled",
                                                       .format = Format::rgba32_float,
                                                       .extent = {16, 16, 1},
                                                       .mips = 3,
                                                       .usage = TextureUsage::sampled}));
        Sampler sampler = must(device_.create_sampler({.magnification = FilterMode::nearest}));
        Buffer points = make_buffer(64 * 16), results = make_buffer(64 * 16);
        Pass pass = commands.pass("sample");
        const uint32_t mip = below(3);
        pass.clear(picture.mip<d2>(mip), std::array<float, 4>{1, 2, 3, 4});
        pass.fill(points.slice(0, 1024));
        pass.dispatch(sample_,
                      {.source = {picture.view<d2>({.first_mip = mip, .mips = 1}), sampler.handle()},
                       .Points = points.slice(0, 1024),
                       .Results = results.slice(0, 1024)},
                      {.count = 64, .lod = 0}, {1});
        Texture& other = any(textures_);
        pass.clear(other.view({.first_mip = below(other.desc().mips), .mips = 1}),
                   zero_of(other.desc().format));
    }

    static ClearValue zero_of(Format format) {
        if (format == Format::r32_uint) return std::array<uint32_t, 4>{};
        return std::array<float, 4>{};
    }

    void draw(Commands& commands) {
        if (below(4)) return;
        Texture target = must(device_.create_texture({.name = "target",
                                                      .dimension = d2_array,
                                                      .format = Format::rgba8_unorm,
                                                      .extent = {1 + below(32), 1 + below(32), 1},
                                                      .layers = 3,
                                                      .usage = TextureUsage::attachment}));
        Buffer vertices = make_buffer(3 * 32);
        commands.pass("vertices").fill(vertices.slice(0, 96), below(2) ? 0 : 0x3f800000);
        RasterPass pass = commands.raster_pass(
            "draw", {.color = {{.view = target.view<d2>({.first_layer = below(3), .layers = 1})}}});
        pass.draw(draw_, {vertices.slice(0, 96)}, {.tint = {1, 1, 1, 1}, .offset = {0, 0}},
                  Draw{.vertices = 3});
    }

    Device& device_;
    std::mt19937 random_{20'261'122};
    int frame_ = 0;
    uint32_t expected_ = 0;
    ComputePipeline<advance> step_;
    ComputePipeline<sample_d2> sample_;
    RasterPipeline<pull> draw_;
    std::vector<Buffer> buffers_;
    std::vector<Texture> textures_;
};

struct SoakTest : testing::TestWithParam<Api> {
    /// LUMO_SOAK_FRAMES sets another number, and asks for a line for every look. Validation layers keep records
    /// that grow, and sanitizers what was freed: the process is looked at without them alone.
    void soak(Device& device, int frames, bool whole_process) {
        const char* wanted = std::getenv("LUMO_SOAK_FRAMES");
        if (wanted) frames = std::atoi(wanted);
        ASSERT_GT(frames, settled_after);
        Soak soak(device);
        Held settled;
        for (int frame = 1; frame <= frames; ++frame) {
            soak.frame();
            if (frame % frames_per_look != 0) continue;
            const Held held = soak.look();
            if (wanted) fmt::print("{} frame {}: {}\n", to_string(GetParam()), frame, held.words());
            if (frame <= settled_after) settled = held;
            ASSERT_LE(held.device_bytes, settled.device_bytes) << "frame " << frame;
            ASSERT_LE(held.device_entries, settled.device_entries) << "frame " << frame;
            ASSERT_LE(held.objects, settled.objects) << "frame " << frame;
            if (whole_process && !sanitized) {
                ASSERT_LE(held.resident_bytes, settled.resident_bytes + resident_slack) << "frame " << frame;
            }
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Device, SoakTest, both_apis, api_name);

TEST_P(SoakTest, NothingIsLeftOfWhatFramesMadeAndNothingIsSaid) {
    const FaultyDriver counted(GetParam());
    auto opened = open_device(GetParam(), {.disk_cache = false});
    if (!opened) GTEST_SKIP() << "no device for " << to_string(GetParam());
    soak(*opened->device, sanitized ? 1000 : 10'000, false);
    opened->device.reset();
    for (const Message& message : opened->take_failures())
        ADD_FAILURE() << message.id << ": " << message.text;
}

TEST_P(SoakTest, TheProcessDoesNotGrow) {
    auto device = backends::create_device(GetParam(), {.disk_cache = false});
    if (!device) GTEST_SKIP() << to_string(device.error());
    soak(*device, sanitized ? 1000 : 3000, true);
}

}  // namespace
}  // namespace lumo::rhi
