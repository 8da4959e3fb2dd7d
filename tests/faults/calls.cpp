// Every call of the driver that takes memory fails once: an error says why, nothing is left of what was begun,
// and the device goes on with the right results.
#include <fmt/format.h>
#include <functional>
#include <glm/vec4.hpp>

#include "rhi/backend.hpp"
#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "shaders/test_rhi/sample_d2.hpp"
#include "shaders/test_rhi/scale.hpp"
#include "shaders/test_rhi/several.hpp"
#include "shaders/test_rhi/store_d2.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/faults.hpp"

namespace lumo::rhi {
namespace {

using namespace testing_support;
using namespace shaders::test_rhi;
using enum Dimension;
using testing::Each;
using testing::HasSubstr;
using testing::SizeIs;

/// What an operation ends with when something is refused.
struct Refused {
    Error error;
};

template <class T>
T want(Result<T> result) {
    if (!result) throw Refused{std::move(result.error())};
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// What a user does with a device, until it is done or refused. Its results are tested as they come.
using Operation = std::function<void(Device&)>;

Result<void> attempt(const Operation& operation, Device& device) {
    try {
        operation(device);
        return {};
    } catch (const Refused& refused) {
        return tl::unexpected(refused.error);
    }
}

/// The resources that a user owns; staging memory is the device's own, and kept.
std::vector<std::string> owned(const Device& device) {
    std::vector<std::string> names;
    for (const MemoryEntry& entry : device.memory())
        if (entry.name != "staging" && entry.name != "readback") names.push_back(entry.name);
    return names;
}

/// Work whose result shows that a device still does what it is told.
class Witness {
  public:
    explicit Witness(Device& device)
        : device_(device),
          values_(must(device.create_buffer({.name = "values", .size = 64 * 4}))),
          step_(must(device.create_compute_pipeline<advance>())),
          draw_(must(device.create_raster_pipeline<several>({.color = {{.format = Format::rgba32_float},
                                                                       {.format = Format::rgba32_uint},
                                                                       {.format = Format::rgba8_unorm}}}))) {
        for (Format format : {Format::rgba32_float, Format::rgba32_uint, Format::rgba8_unorm})
            targets_.push_back(must(device.create_texture({.name = "target",
                                                           .format = format,
                                                           .extent = {4, 4, 1},
                                                           .usage = TextureUsage::attachment})));
    }

    void expect_right_results() {
        ++start_;
        must(device_.upload(values_.slice(), bytes_of(std::vector<uint32_t>(64, start_))));
        Commands commands = device_.begin();
        {
            Pass pass = commands.pass("step");
            for (int i = 0; i < 2; ++i) pass.dispatch(step_, {values_.slice()}, {}, {1});
        }
        {
            RasterPass pass = commands.raster_pass("draw", {.color = {{.view = targets_[0].view()},
                                                                      {.view = targets_[1].view()},
                                                                      {.view = targets_[2].view()}}});
            pass.draw(draw_, {}, {}, Draw{.vertices = 3});
        }
        must(device_.wait(device_.submit(std::move(commands))));
        EXPECT_THAT(values_of<uint32_t>(must(device_.download(values_.slice()))), Each(start_ * 9 + 4));
        const auto which =
            values_of<uint32_t>(must(device_.download(targets_[1], whole_mip(targets_[1].desc()))));
        for (uint32_t i = 0; i < 16; ++i) EXPECT_EQ(which[i * 4], i % 4 + 100 * (i / 4));
    }

  private:
    Device& device_;
    uint32_t start_ = 0;
    Buffer values_;
    ComputePipeline<advance> step_;
    RasterPipeline<several> draw_;
    std::vector<Texture> targets_;
};

/// Lets the device finish with what was destroyed.
void settle(Device& device) {
    for (uint32_t i = 0; i <= max_in_flight; ++i) must(device.wait(device.submit(device.begin())));
}

struct FaultTest : testing::TestWithParam<Api> {
    void SetUp() override {
        if (!open_device(GetParam())) GTEST_SKIP() << "no device for " << to_string(GetParam());
    }

    struct Opened {
        std::unique_ptr<CheckedDevice> checked;  // stays where the witness finds it
        std::unique_ptr<Witness> witness;

        Device& device() { return *checked->device; }
        std::map<std::string, int64_t> live() {
            witness->expect_right_results();
            settle(device());
            return faults().live();
        }
        void close() {
            witness.reset();
            checked->device.reset();
            for (const Message& message : checked->take_failures())
                ADD_FAILURE() << message.id << ": " << message.text;
        }
    };
    Opened open() {
        faults().start_counting();
        auto device = open_device(GetParam(), {.timing = Timing::overlapped, .disk_cache = false});
        if (!device) throw std::runtime_error("no device");
        Opened opened{std::make_unique<CheckedDevice>(std::move(*device)), nullptr};
        opened.witness = std::make_unique<Witness>(opened.device());
        opened.witness->expect_right_results();
        return opened;
    }

    /// Runs `operation` as often as it takes until each of its calls has failed once: on one device, or `anew`
    /// each on a device that has nothing yet.
    void fail_each_call(const Operation& operation, bool anew = false) {
        Opened opened = open();
        must(attempt(operation, opened.device()));
        const auto without_faults = opened.live();
        const auto owned_before = owned(opened.device());
        std::vector<std::string> failed;
        for (int call = 0;; ++call) {
            if (anew) {
                opened.close();
                opened = open();
            }
            faults().arm(call);
            const Result<void> done = attempt(operation, opened.device());
            const std::string function = faults().disarm();
            if (function.empty()) {
                must(done);
                break;
            }
            SCOPED_TRACE(fmt::format("call {}, {}", call, function));
            failed.push_back(function);
            if (!done) {
                EXPECT_EQ(done.error().kind, ErrorKind::out_of_memory) << to_string(done.error());
                EXPECT_FALSE(done.error().subject.empty());
                EXPECT_FALSE(done.error().message.empty());
                ++errors_;
            }
            for (const Message& message : opened.checked->take_failures())
                EXPECT_EQ(message.id, "device") << message.text;
            for (const auto& [kind, number] : opened.live()) {
                const auto most = without_faults.find(kind);
                EXPECT_LE(number, most == without_faults.end() ? 0 : most->second) << "leaks a " << kind;
            }
            EXPECT_EQ(owned(opened.device()), owned_before);
            if (HasFailure()) break;
        }
        EXPECT_GT(errors_, 0) << "of " << failed.size() << " calls";
        opened.close();
        if (GetParam() == Api::vulkan) {
            EXPECT_THAT(faults().live(), testing::IsEmpty());
        }
        RecordProperty("failed_calls", int(failed.size()));
        RecordProperty("errors", errors_);
        fmt::print("{}: {} calls failed, {} errors: {}\n", to_string(GetParam()), failed.size(), errors_,
                   fmt::join(failed, " "));
    }

  private:
    FaultyDriver driver_{GetParam()};
    int errors_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Device, FaultTest, both_apis, api_name);

constexpr TextureUsage target_use = TextureUsage::attachment | TextureUsage::sampled;

TEST_P(FaultTest, Buffers) {
    fail_each_call([](Device& device) {
        std::vector<Buffer> all;
        for (Memory memory : {Memory::device, Memory::upload, Memory::readback})
            for (uint64_t size : {uint64_t{1000}, uint64_t{32} << 20})
                all.push_back(want(device.create_buffer({.name = "mine", .size = size, .memory = memory})));
    });
}

TEST_P(FaultTest, TexturesOfEveryShape) {
    fail_each_call([](Device& device) {
        std::vector<Texture> all;
        const auto make = [&](TextureDesc desc) {
            desc.name = "mine";
            all.push_back(want(device.create_texture(desc)));
        };
        make({.dimension = d1, .extent = {16, 1, 1}});
        make({.dimension = d2, .extent = {64, 64, 1}, .mips = 4});
        make({.dimension = d2_array, .extent = {16, 16, 1}, .layers = 3});
        make({.dimension = d3, .extent = {16, 16, 16}});
        make({.dimension = cube, .extent = {16, 16, 1}, .layers = 6});
        make({.dimension = d2_multisample, .extent = {16, 16, 1}, .samples = 4, .usage = target_use});
        make({.dimension = d2, .format = Format::d32_float, .extent = {2048, 2048, 1}, .usage = target_use});
    });
}

TEST_P(FaultTest, Samplers) {
    fail_each_call([](Device& device) { want(device.create_sampler({})); });
}

TEST_P(FaultTest, Pipelines) {
    fail_each_call([](Device& device) {
        (void)want(device.create_compute_pipeline<scale>());
        (void)want(device.create_raster_pipeline<pull>({.color = {{.format = Format::rgba8_unorm}}}));
    });
}

TEST_P(FaultTest, StagingOfUploads) {
    fail_each_call(
        [](Device& device) {
            Buffer into = want(device.create_buffer({.name = "into", .size = 4096}));
            const std::vector<std::byte> bytes(4096, std::byte{7});
            want(device.upload(into.slice(), bytes));
            EXPECT_EQ(want(device.download(into.slice())), bytes);
        },
        true);
}

TEST_P(FaultTest, UploadsAboveABlock) {
    fail_each_call([](Device& device) {
        Buffer into = want(device.create_buffer({.name = "into", .size = uint64_t{20} << 20}));
        want(device.upload(into.slice(), std::vector<std::byte>(into.size(), std::byte{7})));
        EXPECT_THAT(want(device.download(into.slice(into.size() - 4, 4))), Each(std::byte{7}));
    });
}

TEST_P(FaultTest, UploadsWithinASubmission) {
    fail_each_call(
        [](Device& device) {
            Texture picture = want(device.create_texture(
                {.name = "picture", .format = Format::r32_uint, .extent = {32, 32, 1}, .mips = 2}));
            const std::vector<uint32_t> texels(32 * 32, 5);
            Commands commands = device.begin();
            Readback read;
            {
                Pass pass = commands.pass("upload");
                pass.upload(picture, whole_mip(picture.desc()), bytes_of(texels));
                pass.clear(picture.mip<d2>(1), std::array<uint32_t, 4>{9});
                read = pass.read(picture, whole_mip(picture.desc(), 1));
            }
            const Submission submission = device.submit(std::move(commands));
            want(device.wait(submission));
            EXPECT_THAT(values_of<uint32_t>(want(device.take(read))), Each(9u));
        },
        true);
}

TEST_P(FaultTest, TransientUniforms) {
    fail_each_call(
        [](Device& device) {
            Buffer sums = want(device.create_buffer({.name = "sums", .size = 64 * 4}));
            Buffer source = want(device.create_buffer({.name = "source", .size = 64 * 4}));
            const auto pipeline = want(device.create_compute_pipeline<scale>());
            Commands commands = device.begin();
            Readback read;
            {
                Pass pass = commands.pass("scale");
                pass.fill(source.slice(), 3);
                const UniformBuffer settings = commands.uniform(scale::Settings{glm::ivec4(1000)});
                if (settings.slice.buffer)
                    pass.dispatch(pipeline,
                                  {.Source = source.slice(), .settings = settings, .Target = sums.slice()},
                                  {.count = 64, .factor = 2, .pair = {0, 0}}, {1});
                read = pass.read(sums.slice());
            }
            want(device.wait(device.submit(std::move(commands))));
            EXPECT_THAT(values_of<int32_t>(want(device.take(read))), Each(1007));
        },
        true);
}

TEST_P(FaultTest, ViewsForShaders) {
    fail_each_call([](Device& device) {
        Texture picture =
            want(device.create_texture({.name = "picture",
                                        .format = Format::rgba32_float,
                                        .extent = {8, 8, 1},
                                        .mips = 2,
                                        .usage = TextureUsage::sampled | TextureUsage::storage}));
        Buffer results = want(device.create_buffer({.name = "results", .size = 64 * 16}));
        Buffer points = want(device.create_buffer({.name = "points", .size = 64 * 16}));
        const auto store = want(device.create_compute_pipeline<store_d2>());
        const auto sample = want(device.create_compute_pipeline<sample_d2>());
        Sampler nearest = want(device.create_sampler(
            {.magnification = FilterMode::nearest, .minification = FilterMode::nearest}));
        // Twice: what failed is not kept as if it were there.
        Result<void> last;
        for (int i = 0; i < 2; ++i) {
            Commands commands = device.begin();
            Readback read;
            {
                Pass pass = commands.pass("views");
                pass.fill(points.slice());
                pass.dispatch(store, {picture.mip<d2>(1)}, {.size = {4, 4, 1}, .base = 40}, {1});
                pass.dispatch(sample,
                              {.source = {picture.view<d2>({.first_mip = 1}), nearest.handle()},
                               .Points = points.slice(),
                               .Results = results.slice()},
                              {.count = 64, .lod = 0}, {1});
                read = pass.read(results.slice());
            }
            const Submission submission = device.submit(std::move(commands));
            const auto done = device.wait(submission);
            const auto bytes = device.take(read);
            EXPECT_EQ(bool(bytes), bool(done));
            if (bytes) {
                EXPECT_THAT(values_of<glm::vec4>(*bytes), Each(glm::vec4(40, 0, 0, 1)));
            }
            EXPECT_FALSE(!done && !last) << "a second time";
            if (!done) last = done;
        }
        want(std::move(last));
    });
}

TEST_P(FaultTest, ViewsForTargets) {
    fail_each_call([](Device& device) {
        Texture color = want(device.create_texture({.name = "color",
                                                    .dimension = d2_array,
                                                    .format = Format::rgba32_float,
                                                    .extent = {16, 16, 1},
                                                    .layers = 4,
                                                    .mips = 2,
                                                    .usage = target_use}));
        Texture depth = want(device.create_texture({.name = "depth",
                                                    .format = Format::d32_float,
                                                    .extent = {16, 16, 1},
                                                    .mips = 2,
                                                    .usage = target_use}));
        Result<void> last;
        for (int i = 0; i < 2; ++i) {
            Commands commands = device.begin();
            (void)commands.raster_pass(
                "clear", {.color = {{.view = color.view<d2>(
                                         {.first_mip = 1, .mips = 1, .first_layer = 2, .layers = 1}),
                                     .clear = std::array<float, 4>{1, 2, 3, 4}}},
                          .depth = DepthTarget{.view = depth.mip<d2>(1), .clear = 0.5f}});
            const auto done = device.wait(device.submit(std::move(commands)));
            EXPECT_FALSE(!done && !last) << "a second time";
            if (!done) last = done;
        }
        want(std::move(last));
        const auto texels = values_of<float>(want(device.download(depth, whole_mip(depth.desc(), 1))));
        EXPECT_THAT(texels, Each(0.5f));
    });
}

TEST_P(FaultTest, MipsResolvesAndCopies) {
    fail_each_call([](Device& device) {
        const auto make = [&](TextureDesc desc) {
            desc.name = "mine";
            if (desc.dimension != d3) desc.usage = target_use;
            return want(device.create_texture(desc));
        };
        Texture flat = make({.extent = {16, 16, 1}, .mips = 3});
        Texture volume = make({.dimension = d3, .extent = {8, 8, 8}, .mips = 2});
        Texture samples = make({.dimension = d2_multisample, .extent = {16, 16, 1}, .samples = 4});
        Texture average = make({.extent = {16, 16, 1}});
        Commands commands = device.begin();
        (void)commands.raster_pass("clear", {.color = {{.view = samples.view(),
                                                        .clear = std::array<float, 4>{1, 1, 1, 1},
                                                        .resolve = average.view()}}});
        {
            Pass pass = commands.pass("copies");
            pass.clear(flat.mip<d2>(0), std::array<float, 4>{1, 1, 1, 1});
            pass.generate_mips(flat);
            pass.clear(volume.mip<d3>(0));
            pass.generate_mips(volume);
        }
        want(device.wait(device.submit(std::move(commands))));
        EXPECT_THAT(want(device.download(flat, whole_mip(flat.desc(), 2))), Each(std::byte{255}));
        EXPECT_THAT(want(device.download(average, whole_mip(average.desc()))), Each(std::byte{255}));
    });
}

TEST_P(FaultTest, ManyTimedPasses) {
    fail_each_call(
        [](Device& device) {
            Buffer values = want(device.create_buffer({.name = "values", .size = 64}));
            Commands commands = device.begin();
            for (uint32_t i = 0; i < 150; ++i) commands.pass("pass").fill(values.slice(), i);
            const Submission submission = device.submit(std::move(commands));
            const auto done = device.wait(submission);
            // None where the submission did not run at all; those that could not be timed took no time.
            EXPECT_THAT(device.pass_times(submission), testing::AnyOf(SizeIs(150), SizeIs(0)));
            want(std::move(done));
            EXPECT_THAT(values_of<uint32_t>(want(device.download(values.slice()))), Each(149u));
        },
        true);
}

TEST_P(FaultTest, DescriptorSetsWherePushingIsNotPossible) {
    if (GetParam() == Api::gl) GTEST_SKIP() << "OpenGL has none";
    faults().hide_push_descriptors(true);
    // More than a pool holds: the first of each kind fails, then the second.
    for (const char* function : {"vkCreateDescriptorPool", "vkAllocateDescriptorSets"}) {
        for (int call : {0, 1, 300}) {
            SCOPED_TRACE(fmt::format("{} {}", function, call));
            Opened opened = open();
            Device& device = opened.device();
            Buffer values = must(device.create_buffer({.name = "values", .size = 256}));
            const auto step = must(device.create_compute_pipeline<advance>());
            const auto frame = [&] {
                must(device.upload(values.slice(), bytes_of(std::vector<uint32_t>(64, 1))));
                Commands commands = device.begin();
                {
                    Pass pass = commands.pass("steps");
                    for (int i = 0; i < 400; ++i) pass.dispatch(step, {values.slice()}, {}, {1});
                }
                return device.wait(device.submit(std::move(commands)));
            };
            faults().arm(call, function);
            const auto failed = frame();
            // What a pool refuses, another gives.
            if (!faults().disarm().empty() && !failed) {
                EXPECT_EQ(failed.error().kind, ErrorKind::out_of_memory);
            }
            opened.checked->take_failures();
            must(frame());
            uint32_t expected = 1;
            for (int i = 0; i < 400; ++i) expected = expected * 3 + 1;
            EXPECT_THAT(values_of<uint32_t>(must(device.download(values.slice()))), Each(expected));
            values = {};
            opened.witness->expect_right_results();
        }
    }
    faults().hide_push_descriptors(false);
}

/// A submission that could not run at all leaves textures as they were.
TEST_P(FaultTest, WhatASubmissionDidNotDoIsNotTakenForDone) {
    fail_each_call([](Device& device) {
        Texture kept = want(device.create_texture(
            {.name = "kept", .format = Format::r32_uint, .extent = {8, 8, 1}, .usage = target_use}));
        Texture fresh = want(device.create_texture(
            {.name = "fresh", .format = Format::r32_uint, .extent = {8, 8, 1}, .usage = target_use}));
        const std::vector<uint32_t> sevens(64, 7);
        want(device.upload(kept, whole_mip(kept.desc()), bytes_of(sevens)));
        Commands commands = device.begin();
        {
            Pass pass = commands.pass("copy");
            pass.copy(kept, whole_mip(kept.desc()), fresh, whole_mip(fresh.desc()));
        }
        const auto copied = device.wait(device.submit(std::move(commands)));
        EXPECT_EQ(values_of<uint32_t>(want(device.download(kept, whole_mip(kept.desc())))), sevens);
        if (!copied) {
            Commands again = device.begin();
            again.pass("copy").copy(kept, whole_mip(kept.desc()), fresh, whole_mip(fresh.desc()));
        }
        EXPECT_EQ(values_of<uint32_t>(want(device.download(fresh, whole_mip(fresh.desc())))), sevens);
        want(std::move(copied));
    });
}

TEST_P(FaultTest, TheDeviceItself) {
    int failed = 0, errors = 0;
    for (int call = 0;; ++call) {
        faults().start_counting();
        faults().arm(call);
        CheckedDevice checked;
        auto made = backends::create_device(
            GetParam(), {.validation = true, .disk_cache = false, .sink = [&](const Message& message) {
                             checked.messages->push_back(message);
                         }});
        const std::string function = faults().disarm();
        if (function.empty()) {
            must(std::move(made));
            break;
        }
        SCOPED_TRACE(function);
        ++failed;
        if (made) {
            checked.device = std::move(*made);
            Witness(*checked.device).expect_right_results();
            checked.device.reset();
        } else {
            ++errors;
            EXPECT_EQ(made.error().kind, ErrorKind::out_of_memory) << to_string(made.error());
        }
        if (GetParam() == Api::vulkan) {
            EXPECT_THAT(faults().live(), testing::IsEmpty());
        }
        for (const Message& message : checked.take_failures()) ADD_FAILURE() << message.id << message.text;
    }
    EXPECT_GT(errors, 0);
    fmt::print("{}: {} calls failed, {} errors\n", to_string(GetParam()), failed, errors);
    auto sound = open_device(GetParam());
    ASSERT_TRUE(sound);
    Witness(*sound->device).expect_right_results();
}

TEST_P(FaultTest, ErrorsSayWhatWasAskedFor) {
    Opened opened = open();
    Device& device = opened.device();
    const auto refused = [&](const auto& make) {
        faults().arm(0);
        auto made = make();
        EXPECT_NE(faults().disarm(), "");
        if (made) throw std::runtime_error("it was made all the same");
        return to_string(made.error());
    };
    EXPECT_THAT(refused([&] { return device.create_buffer({.name = "lights", .size = 12345}); }),
                testing::AllOf(HasSubstr("lights"), HasSubstr("12345 bytes")));
    EXPECT_THAT(refused([&] {
                    return device.create_texture(
                        {.name = "sky", .format = Format::rgba16_float, .extent = {33, 44, 1}});
                }),
                testing::AllOf(HasSubstr("sky"), HasSubstr("33x44x1"), HasSubstr("rgba16_float")));
    EXPECT_THAT(refused([&] { return device.create_sampler({}); }), HasSubstr("sampler"));
    EXPECT_THAT(refused([&] { return device.create_compute_pipeline<store_d2>(); }),
                HasSubstr("test_rhi/store_d2"));
    opened.close();
}

// -- loss

TEST_P(FaultTest, ALostDeviceIsSaidOnceWhereverItIsFoundAndThenEveryCallSaysSo) {
    int found_at = 0;
    for (int call = 0;; ++call) {
        Opened opened = open();
        Device& device = opened.device();
        Buffer mine = must(device.create_buffer({.name = "mine", .size = 256}));
        Texture picture = must(device.create_texture({.name = "picture", .extent = {4, 4, 1}}));
        faults().arm_loss(call);
        const std::vector<std::byte> bytes(256);
        (void)device.upload(mine.slice(), bytes);
        (void)device.download(mine.slice());
        Commands commands = device.begin();
        commands.pass("fill").fill(mine.slice());
        const Submission submission = device.submit(std::move(commands));
        (void)device.wait(submission);
        if (!faults().is_lost()) {
            faults().disarm();
            mine = {};
            picture = {};
            opened.close();
            break;
        }
        ++found_at;
        SCOPED_TRACE(call);

        const auto lost = [](const auto& result) {
            ASSERT_FALSE(result);
            EXPECT_EQ(result.error().kind, ErrorKind::device_lost) << to_string(result.error());
        };
        lost(device.wait(submission));
        lost(device.upload(mine.slice(), bytes));
        lost(device.upload(picture, whole_mip(picture.desc()), std::vector<std::byte>(64)));
        lost(device.download(mine.slice()));
        lost(device.download(picture, whole_mip(picture.desc())));
        lost(device.create_buffer({.name = "another", .size = 16}));
        lost(device.create_texture({.name = "another", .extent = {4, 4, 1}}));
        lost(device.create_sampler({}));
        lost(device.create_compute_pipeline<advance>());
        lost(device.create_raster_pipeline<pull>({.color = {{.format = Format::rgba8_unorm}}}));
        for (int frame = 0; frame < 4; ++frame) {
            Commands more = device.begin();
            Readback read;
            {
                Pass pass = more.pass("more");
                (void)more.uniform(glm::vec4(1));
                pass.upload(mine.slice(), bytes);
                pass.fill(mine.slice());
                read = pass.read(mine.slice());
            }
            const Submission after = device.submit(std::move(more));
            EXPECT_TRUE(device.finished(after)) << "nothing runs any more";
            lost(device.wait(after));
            lost(device.take(read));
            EXPECT_TRUE(device.pass_times(after).empty());
        }
        (void)device.memory_budget();

        const auto failures = opened.checked->take_failures();
        ASSERT_EQ(failures.size(), 1u) << "one message";
        EXPECT_THAT(failures[0].text, HasSubstr(GetParam() == Api::gl ? "reset" : "lost"));
        mine = {};
        picture = {};
        opened.close();
        faults().disarm();
    }
    EXPECT_GE(found_at, 3) << "places where the loss can be found";
    fmt::print("{}: lost in {} places\n", to_string(GetParam()), found_at);
}

// -- choice

TEST_P(FaultTest, ANamedDeviceThatCannotBeMadeIsNotReplacedByAnother) {
    const auto all = backends::list_devices(GetParam());
    ASSERT_FALSE(all.empty());
    auto refused = backends::create_device(GetParam(), {.name = all[0].name + " of another kind"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::no_device);
    EXPECT_THAT(to_string(refused.error()), HasSubstr("of another kind"));
    EXPECT_THAT(to_string(refused.error()), HasSubstr(all[0].name)) << "what was found";
}

}  // namespace
}  // namespace lumo::rhi
