#include <algorithm>
#include <bit>
#include <cstddef>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <type_traits>

#include "shadercompiler/generate.hpp"
#include "shaders/unit_shaders/everything.hpp"
#include "shaders/unit_shaders/nothing.hpp"
#include "shaders/unit_shaders/raster.hpp"
#include "tests/unit/shadercompiler_fixture.hpp"

namespace lumo::shadercompiler {
namespace {

using lumo::shaders::unit_shaders::everything;
using lumo::shaders::unit_shaders::nothing;
using lumo::shaders::unit_shaders::raster;
using rhi::Dimension;
using rhi::TexelKind;
using testing::HasSubstr;

static_assert(rhi::Program<everything> && rhi::Program<raster> && rhi::Program<nothing>);
static_assert(std::is_same_v<decltype(everything::Bindings::radiance), rhi::Sampled<Dimension::d3>>);
static_assert(std::is_same_v<decltype(everything::Bindings::codes),
                             rhi::Sampled<Dimension::d2_array, TexelKind::uint>>);
static_assert(std::is_same_v<decltype(everything::Bindings::counts),
                             rhi::StorageImage<Dimension::d3, TexelKind::uint>>);
static_assert(std::is_same_v<decltype(everything::Bindings::samples), rhi::StorageBuffer>);
static_assert(std::is_same_v<decltype(everything::Bindings::lights), rhi::UniformBuffer>);
static_assert(std::is_same_v<nothing::Push, rhi::NoPush> && std::is_same_v<nothing::Options, rhi::NoOptions>);
static_assert(std::is_same_v<decltype(everything::Push::size), glm::uvec2>);
static_assert(sizeof(everything::Light) == 32 && offsetof(everything::Lights, grid) == 112);
static_assert(std::is_same_v<decltype(everything::Lights::enabled), uint32_t>, "bool in a block has 32 bits");

template <Dimension D>
rhi::View<D> view(uint32_t index) {
    rhi::View<D> view;
    view.texture = {index, 1};
    view.dimension = D;
    return view;
}

TEST(Generated, BindingsComeInTheOrderOfTheReflection) {
    const rhi::SamplerHandle sampler{7, 1};
    const raster::Bindings bindings{
        .base_color = {view<Dimension::d2>(1), sampler},
        .hits = view<Dimension::d2>(2),
        .Vertices = rhi::BufferSlice{.buffer = {3, 1}, .offset = 16, .size = 64},
        .shadow = {view<Dimension::d2>(4), sampler},
        .unused = {view<Dimension::d2>(5), sampler},
    };
    const auto values = bindings.values();
    const auto infos = raster::info().bindings;
    ASSERT_EQ(values.size(), infos.size());
    for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i].kind, infos[i].kind) << infos[i].name;
    EXPECT_EQ(values[0].view.texture.index, 1u);
    EXPECT_EQ(values[0].sampler, sampler);
    EXPECT_EQ(values[1].view.texture.index, 2u);
    EXPECT_EQ(values[2].slice, (rhi::BufferSlice{.buffer = {3, 1}, .offset = 16, .size = 64}));
    EXPECT_EQ(values[3].view.texture.index, 4u);
    EXPECT_TRUE(nothing::Bindings{}.values().empty());
}

TEST(Generated, OptionsHaveTheDefaultsOfTheSource) {
    const everything::Options options;
    EXPECT_TRUE(options.fast);
    EXPECT_EQ(options.bias, -3);
    EXPECT_EQ(options.count, 12u);
    EXPECT_EQ(options.scale, 0.1f);
    const auto values = options.values();
    const auto infos = everything::info().options;
    ASSERT_EQ(values.size(), infos.size());
    for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], infos[i].default_bits) << infos[i].name;
    const auto changed = everything::Options{.fast = false, .bias = -1, .scale = 2}.values();
    EXPECT_EQ(changed, (std::array<uint32_t, 4>{0, ~0u, 12, std::bit_cast<uint32_t>(2.0f)}));
}

TEST(Generated, PushHasTheSizeOfTheReflection) {
    EXPECT_EQ(sizeof(everything::Push), everything::info().push_size);
    EXPECT_EQ(sizeof(raster::Push), raster::info().push_size);
    EXPECT_EQ(nothing::info().push_size, 0u);
}

TEST(Generated, CodeIsWhatTheRunTimeCompilerMakes) {
    const rhi::ProgramInfo* built[] = {&everything::info(), &raster::info(), &nothing::info()};
    for (const rhi::ProgramInfo* info : built) {
        const auto compilation = compile_data(std::string(info->name));
        ASSERT_TRUE(compilation) << to_string(compilation.error());
        const rhi::ProgramInfo& compiled = compilation->program.info();
        EXPECT_EQ(info->hash, compiled.hash);
        EXPECT_EQ(info->local_size, compiled.local_size);
        EXPECT_EQ(info->color_outputs, compiled.color_outputs);
        ASSERT_EQ(info->stages.size(), compiled.stages.size());
        for (size_t i = 0; i < info->stages.size(); ++i) {
            EXPECT_EQ(info->stages[i].stage, compiled.stages[i].stage);
            EXPECT_TRUE(std::ranges::equal(info->stages[i].spirv, compiled.stages[i].spirv));
            EXPECT_EQ(info->stages[i].glsl, compiled.stages[i].glsl);
        }
        ASSERT_EQ(info->bindings.size(), compiled.bindings.size());
        for (size_t i = 0; i < info->bindings.size(); ++i) {
            const rhi::BindingInfo& a = info->bindings[i];
            const rhi::BindingInfo& b = compiled.bindings[i];
            EXPECT_EQ(a.name, b.name);
            EXPECT_EQ(a.binding, b.binding) << a.name;
            EXPECT_EQ(a.kind, b.kind) << a.name;
            EXPECT_EQ(a.dimension, b.dimension) << a.name;
            EXPECT_EQ(a.texel, b.texel) << a.name;
            EXPECT_EQ(a.format, b.format) << a.name;
            EXPECT_EQ(a.access, b.access) << a.name;
            EXPECT_EQ(a.stages, b.stages) << a.name;
            EXPECT_EQ(a.gl_slot, b.gl_slot) << a.name;
            EXPECT_EQ(a.min_size, b.min_size) << a.name;
        }
    }
}

Result<Generated> generate(const std::string& declarations, const std::string& name = "test/one") {
    ProgramSource source = compute(declarations, "");
    source.name = name;
    const auto compilation = compile_program(source, {});
    if (!compilation) return tl::unexpected(compilation.error());
    return generate_cpp(*compilation);
}

TEST(Generator, IsDeterministic) {
    const auto once = compile_data("unit_shaders/everything");
    const auto again = compile_data("unit_shaders/everything");
    ASSERT_TRUE(once && again);
    EXPECT_EQ(generate_cpp(*once)->header, generate_cpp(*again)->header);
    EXPECT_EQ(generate_cpp(*once)->source, generate_cpp(*again)->source);
}

TEST(Generator, NestsNamespacesAsFolders) {
    const auto generated = generate("", "one/two/three");
    ASSERT_TRUE(generated) << to_string(generated.error());
    EXPECT_THAT(generated->header, HasSubstr("namespace lumo::shaders::one::two {"));
    EXPECT_THAT(generated->header, HasSubstr("struct three {"));
    EXPECT_THAT(generated->source, HasSubstr("#include \"shaders/one/two/three.hpp\""));
}

TEST(Generator, PadsBlocks) {
    const auto generated =
        generate("layout(binding = 0) uniform Block { float a; vec2 b; float c; mat2x4 d; } block;");
    ASSERT_TRUE(generated) << to_string(generated.error());
    EXPECT_THAT(generated->header, HasSubstr("        float a;\n"
                                             "        std::array<uint32_t, 1> padding_4{};\n"
                                             "        glm::vec2 b;\n"
                                             "        float c;\n"
                                             "        std::array<uint32_t, 3> padding_20{};\n"
                                             "        glm::mat2x4 d;\n"));
    EXPECT_THAT(generated->header, HasSubstr("static_assert(sizeof(one::Block) == 64);"));
}

TEST(Generator, SharesStructsAmongBlocks) {
    const auto generated = generate(
        "struct Light { vec3 p; float r; };\nlayout(binding = 0) uniform A { Light l[2]; } a;\n"
        "layout(binding = 1) uniform B { vec4 x; Light l; } b;\nlayout(push_constant) uniform Push { Light "
        "l; } push;");
    ASSERT_TRUE(generated) << to_string(generated.error());
    const size_t first = generated->header.find("struct Light {");
    EXPECT_NE(first, std::string::npos);
    EXPECT_EQ(generated->header.find("struct Light {", first + 1), std::string::npos);
}

TEST(Generator, KeepsOddDefaults) {
    const auto generated = generate(
        "layout(constant_id = 0) const float small = 1e-30;\nlayout(constant_id = 1) const float large = "
        "3e38;\n"
        "layout(constant_id = 2) const int lowest = -2147483647 - 1;\nlayout(constant_id = 3) const float "
        "one = 1;");
    ASSERT_TRUE(generated) << to_string(generated.error());
    EXPECT_THAT(generated->header, HasSubstr("float small = 1e-30f;"));
    EXPECT_THAT(generated->header, HasSubstr("float large = 3.00000001e+38f;"));
    EXPECT_THAT(generated->header, HasSubstr("int32_t lowest = int32_t(2147483648u);"));
    EXPECT_THAT(generated->header, HasSubstr("float one = 1.0f;"));
}

struct Refusal {
    const char* what;
    const char* declarations;
    const char* name;
    const char* message;
};

class RefusedByTheGenerator : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedByTheGenerator, WithTheReason) {
    const auto generated = generate(GetParam().declarations, GetParam().name);
    ASSERT_FALSE(generated);
    EXPECT_EQ(generated.error().kind, ErrorKind::shader);
    EXPECT_THAT(generated.error().message, HasSubstr(GetParam().message));
}

constexpr Refusal refusals[] = {
    {"array_of_floats", "layout(binding = 0) uniform A { float x[4]; } a;", "test/one",
     "A.x: C++ cannot express an array of 4 bytes every 16"},
    {"array_of_vec3", "layout(binding = 0) uniform A { vec3 x[4]; } a;", "test/one",
     "A.x: C++ cannot express an array of 12 bytes every 16"},
    {"mat3", "layout(binding = 0) uniform A { mat3 x; } a;", "test/one",
     "A.x: C++ cannot express this matrix"},
    {"row_major", "layout(binding = 0) uniform A { layout(row_major) mat4 x; } a;", "test/one",
     "A.x: C++ cannot express this matrix"},
    {"keyword_as_binding", "layout(binding = 0) uniform sampler2D new;", "test/one",
     "'new' is no C++ identifier"},
    {"name_of_a_function", "layout(binding = 0) uniform sampler2D values;", "test/one", "'values' is a name"},
    {"block_with_a_taken_name", "layout(binding = 0) uniform Options { vec4 x; } a;", "test/one",
     "'Options' is a name"},
    {"keyword_as_folder", "", "new/one", "the folder's name"},
    {"folder_with_a_dash", "", "a-b/one", "the folder's name"},
    {"digit_first", "", "test/2d", "the file's name"},
    {"no_folder", "", "one", "live in a folder"},
};

INSTANTIATE_TEST_SUITE_P(All, RefusedByTheGenerator, testing::ValuesIn(refusals),
                         [](const auto& param) { return param.param.what; });

}  // namespace
}  // namespace lumo::shadercompiler
