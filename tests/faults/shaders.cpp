// Programs that are compiled at run time, and those that the driver refuses.
#include <filesystem>
#include <unistd.h>

#include "shadercompiler/compile.hpp"
#include "shaders/test_rhi/advance.hpp"
#include "shaders/test_rhi/pull.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/full_disk.hpp"

namespace lumo::rhi {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;
using namespace shaders::test_rhi;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;

/// A program with the bindings of another, and code that a test brings at run time.
template <class P>
struct Brought {
    using Bindings = typename P::Bindings;
    using Push = typename P::Push;
    using Options = NoOptions;
    static const ProgramInfo& info() { return *code; }
    static inline const ProgramInfo* code = nullptr;
};

/// As test_rhi/advance, with another body.
shadercompiler::ProgramSource advance_by(const std::string& body) {
    return {.name = "test/brought",
            .stages = {{Stages::compute, "brought.comp",
                        "layout(local_size_x = 64) in;\n"
                        "layout(std430, binding = 0) LUMO_READ_WRITE buffer Values { uint values[]; };\n"
                        "void main() {\n" +
                            body + "\n}\n"}}};
}

struct ShaderFaultTest : DeviceTest {
    std::vector<uint32_t> run_brought() {
        const auto pipeline = compute<Brought<advance>>();
        Buffer values = buffer_with(std::vector<uint32_t>(64, 10));
        run(pipeline, {values.slice()}, {}, {1});
        return contents<uint32_t>(values);
    }
    void expect_device_goes_on() {
        Buffer values = buffer_with(std::vector<uint32_t>(64, 1));
        run(compute<advance>(), {values.slice()}, {}, {1});
        EXPECT_THAT(contents<uint32_t>(values), Each(4u));
    }

  private:
    FaultyDriver driver_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Device, ShaderFaultTest, both_apis, api_name);

TEST_P(ShaderFaultTest, WhatDoesNotCompileAtRunTimeIsAnErrorAndWhatDoesRuns) {
    const auto broken =
        shadercompiler::compile_program(advance_by("values[gl_GlobalInvocationID.x] = missing;"), {});
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().kind, ErrorKind::shader);
    EXPECT_THAT(broken.error().message, AllOf(HasSubstr("brought.comp:4"), HasSubstr("missing")));

    const auto made =
        must(shadercompiler::compile_program(advance_by("values[gl_GlobalInvocationID.x] += 5u;"), {}));
    Brought<advance>::code = &made.program.info();
    EXPECT_THAT(run_brought(), Each(15u));
}

TEST_P(ShaderFaultTest, RunTimeCompilationNeedsNoRoomOnDisk) {
    const auto disk = FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    const DiskCache cache(disk->folder() / "cache");
    const auto source = advance_by("values[gl_GlobalInvocationID.x] *= 3u;");
    disk->fill();
    for (int i = 0; i < 2; ++i) {
        const auto made = must(shadercompiler::compile_program(source, {}, cache));
        Brought<advance>::code = &made.info();
        EXPECT_THAT(run_brought(), Each(30u));
        disk->empty();
    }
    EXPECT_FALSE(fs::is_empty(cache.folder())) << "kept when there is room";
}

TEST_P(ShaderFaultTest, AProgramThatTheDriverRefusesIsAnErrorThatSaysWhy) {
    const auto live = faults().live();
    if (GetParam() == Api::gl) {
        // A driver reads the text, so it can be given a wrong one.
        const ProgramInfo& right = advance::info();
        StageInfo stage = right.stages[0];
        stage.glsl = "#version 450\nlayout(local_size_x = 64) in;\nvoid main() { nonsense = 1; }\n";
        ProgramInfo wrong = right;
        wrong.stages = {&stage, 1};
        Brought<advance>::code = &wrong;
        const auto refused = device().create_compute_pipeline<Brought<advance>>();
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::shader);
        EXPECT_THAT(to_string(refused.error()),
                    AllOf(HasSubstr("test_rhi/advance"), HasSubstr("compute stage"), HasSubstr("nonsense")));

        // Two stages, each right, that do not fit.
        const ProgramInfo& raster = pull::info();
        std::vector<StageInfo> stages(raster.stages.begin(), raster.stages.end());
        stages.back().glsl =
            "#version 450\nlayout(location = 0) in mat4 color;\nlayout(location = 0) out vec4 result;\n"
            "void main() { result = color[3]; }\n";
        ProgramInfo apart = raster;
        apart.stages = stages;
        Brought<pull>::code = &apart;
        const auto unlinked =
            device().create_raster_pipeline<Brought<pull>>({.color = {{.format = Format::rgba8_unorm}}});
        ASSERT_FALSE(unlinked);
        EXPECT_EQ(unlinked.error().kind, ErrorKind::shader);
        EXPECT_THAT(to_string(unlinked.error()), AllOf(HasSubstr("test_rhi/pull"), HasSubstr("link")));
    } else {
        for (const char* function : {"vkCreateShaderModule", "vkCreateComputePipelines"}) {
            faults().arm_refusal(function);
            const auto refused = device().create_compute_pipeline<advance>();
            EXPECT_EQ(faults().disarm(), function);
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().kind, ErrorKind::shader);
            EXPECT_THAT(to_string(refused.error()), HasSubstr("test_rhi/advance"));
        }
        faults().arm_refusal("vkCreateGraphicsPipelines");
        const auto refused =
            device().create_raster_pipeline<pull>({.color = {{.format = Format::rgba8_unorm}}});
        EXPECT_NE(faults().disarm(), "");
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::shader);
    }
    EXPECT_EQ(faults().live(), live) << "nothing is left";
    expect_device_goes_on();
}

}  // namespace
}  // namespace lumo::rhi
