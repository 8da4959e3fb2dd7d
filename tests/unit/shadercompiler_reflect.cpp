#include <bit>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "tests/unit/shadercompiler_fixture.hpp"

namespace lumo::shadercompiler {
namespace {

using rhi::BindingInfo;
using rhi::BindingKind;
using rhi::Dimension;
using rhi::Format;
using rhi::ShaderAccess;
using rhi::Stages;
using rhi::TexelKind;
using testing::HasSubstr;

std::map<std::string, BindingInfo> by_name(const rhi::ProgramInfo& info) {
    std::map<std::string, BindingInfo> map;
    for (const BindingInfo& binding : info.bindings) map.emplace(binding.name, binding);
    return map;
}

TEST(Reflection, FindsEveryKindOfBinding) {
    const auto compilation = compile_data("unit_shaders/everything");
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    const rhi::ProgramInfo& info = compilation->program.info();
    EXPECT_EQ(info.name, "unit_shaders/everything");
    EXPECT_TRUE(info.is_compute());
    EXPECT_EQ(info.local_size, (std::array<uint32_t, 3>{8, 4, 2}));

    ASSERT_EQ(info.bindings.size(), 8u);
    for (size_t i = 1; i < info.bindings.size(); ++i) {
        EXPECT_LT(info.bindings[i - 1].binding, info.bindings[i].binding);
    }
    auto bindings = by_name(info);

    EXPECT_EQ(bindings.at("radiance").kind, BindingKind::sampled);
    EXPECT_EQ(bindings.at("radiance").dimension, Dimension::d3);
    EXPECT_EQ(bindings.at("radiance").texel, TexelKind::floating);
    EXPECT_EQ(bindings.at("radiance").access, ShaderAccess::read);
    EXPECT_EQ(bindings.at("codes").dimension, Dimension::d2_array);
    EXPECT_EQ(bindings.at("codes").texel, TexelKind::uint);

    EXPECT_EQ(bindings.at("counts").kind, BindingKind::storage_image);
    EXPECT_EQ(bindings.at("counts").dimension, Dimension::d3);
    EXPECT_EQ(bindings.at("counts").texel, TexelKind::uint);
    EXPECT_EQ(bindings.at("counts").format, Format::r32_uint);
    EXPECT_EQ(bindings.at("counts").access, ShaderAccess::atomic) << "through a function's parameter";
    EXPECT_EQ(bindings.at("result").format, Format::rgba16_float);
    EXPECT_EQ(bindings.at("result").access, ShaderAccess::write);

    EXPECT_EQ(bindings.at("samples").kind, BindingKind::storage_buffer);
    EXPECT_EQ(bindings.at("samples").access, ShaderAccess::read);
    EXPECT_EQ(bindings.at("samples").min_size, 16u);
    EXPECT_EQ(bindings.at("State").access, ShaderAccess::read_write) << "a block without an instance name";
    EXPECT_EQ(bindings.at("State").min_size, 16u);
    EXPECT_EQ(bindings.at("totals").access, ShaderAccess::atomic);
    EXPECT_EQ(bindings.at("totals").min_size, 8u);

    EXPECT_EQ(bindings.at("lights").kind, BindingKind::uniform_buffer);
    // Three lights of 32 bytes, ambient with the bool, grid padded to 16, a matrix, two vectors.
    EXPECT_EQ(bindings.at("lights").min_size, 96u + 16 + 16 + 64 + 32);
    for (const BindingInfo& binding : info.bindings) EXPECT_EQ(binding.stages, Stages::compute);
}

TEST(Reflection, FindsOptionsWithDefaults) {
    const auto compilation = compile_data("unit_shaders/everything");
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    const auto options = compilation->program.info().options;
    ASSERT_EQ(options.size(), 4u);
    EXPECT_EQ(options[0].name, "fast");
    EXPECT_EQ(options[0].id, 2u);
    EXPECT_EQ(options[0].type, rhi::OptionType::boolean);
    EXPECT_EQ(options[0].default_bits, 1u);
    EXPECT_EQ(options[1].name, "bias");
    EXPECT_EQ(options[1].type, rhi::OptionType::sint);
    EXPECT_EQ(int32_t(options[1].default_bits), -3);
    EXPECT_EQ(options[2].name, "count");
    EXPECT_EQ(options[2].type, rhi::OptionType::uint);
    EXPECT_EQ(options[2].default_bits, 12u);
    EXPECT_EQ(options[3].name, "scale");
    EXPECT_EQ(options[3].type, rhi::OptionType::floating);
    EXPECT_EQ(std::bit_cast<float>(options[3].default_bits), 0.1f);
}

TEST(Reflection, MergesTheStagesOfAProgram) {
    const auto compilation = compile_data("unit_shaders/raster");
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    const rhi::ProgramInfo& info = compilation->program.info();
    ASSERT_EQ(info.stages.size(), 3u);
    EXPECT_EQ(info.stages[0].stage, Stages::vertex);
    EXPECT_EQ(info.stages[1].stage, Stages::geometry);
    EXPECT_EQ(info.stages[2].stage, Stages::fragment);
    EXPECT_EQ(info.color_outputs, 0b101u);
    EXPECT_EQ(info.push_size, 12u);
    EXPECT_FALSE(info.is_compute());

    auto bindings = by_name(info);
    ASSERT_EQ(bindings.size(), 5u);
    EXPECT_EQ(bindings.at("Vertices").stages, Stages::vertex);
    EXPECT_EQ(bindings.at("base_color").stages, Stages::fragment);
    EXPECT_EQ(bindings.at("shadow").dimension, Dimension::d2);
    EXPECT_EQ(bindings.at("hits").access, ShaderAccess::atomic);
    EXPECT_EQ(bindings.at("unused").stages, Stages::vertex)
        << "declared there, hence a binding, although unused";
}

TEST(Reflection, GivesOpenGlCompactSlotsPerKind) {
    for (const char* name : {"unit_shaders/everything", "unit_shaders/raster"}) {
        const auto compilation = compile_data(name);
        ASSERT_TRUE(compilation) << to_string(compilation.error());
        std::map<BindingKind, uint32_t> next = {{BindingKind::uniform_buffer, rhi::gl_push_slot + 1}};
        for (const BindingInfo& binding : compilation->program.info().bindings) {
            EXPECT_EQ(binding.gl_slot, next[binding.kind]++) << name << ": " << binding.name;
        }
    }
}

TEST(Reflection, KeepsUnusedOptions) {
    const auto compilation =
        compile_program(compute("layout(constant_id = 1) const int unused = 4;", ""), {});
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    ASSERT_EQ(compilation->program.info().options.size(), 1u);
    EXPECT_EQ(compilation->program.info().options[0].name, "unused");
}

struct AccessCase {
    const char* what;
    const char* declaration;
    const char* body;
    ShaderAccess access;
};

class ReflectedAccess : public testing::TestWithParam<AccessCase> {};

TEST_P(ReflectedAccess, IsWhatTheShaderSays) {
    const auto compilation = compile_program(compute(GetParam().declaration, GetParam().body), {});
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    ASSERT_EQ(compilation->program.info().bindings.size(), 1u);
    EXPECT_EQ(compilation->program.info().bindings[0].access, GetParam().access);
}

constexpr AccessCase access_cases[] = {
    {"readonly_image", "layout(binding = 0, r32f) readonly uniform image2D a;", "imageLoad(a, ivec2(0));",
     ShaderAccess::read},
    {"writeonly_image_without_format", "layout(binding = 0) writeonly uniform image2D a;",
     "imageStore(a, ivec2(0), vec4(1));", ShaderAccess::write},
    {"macro_on_image", "layout(binding = 0, r32f) LUMO_READ_WRITE uniform image2D a;",
     "imageStore(a, ivec2(0), imageLoad(a, ivec2(1)));", ShaderAccess::read_write},
    {"macro_after_uniform", "layout(binding = 0, r32f) uniform LUMO_READ_WRITE image2D a;",
     "imageStore(a, ivec2(0), imageLoad(a, ivec2(1)));", ShaderAccess::read_write},
    {"macro_on_atomics", "layout(binding = 0, r32ui) LUMO_READ_WRITE uniform uimage2D a;",
     "imageAtomicAdd(a, ivec2(0), 1u);", ShaderAccess::read_write},
    {"atomics_and_size", "layout(binding = 0, r32i) uniform iimage2D a;",
     "imageAtomicMin(a, imageSize(a) - 1, -1);", ShaderAccess::atomic},
    {"atomics_whose_result_is_used", "layout(binding = 0) buffer A { uint next; uint slots[]; } a;",
     "atomicOr(a.slots[atomicAdd(a.next, 1u)], 1u);", ShaderAccess::atomic},
    {"atomics_and_length", "layout(binding = 0) buffer A { uint slots[]; } a;",
     "atomicOr(a.slots[a.slots.length() - 1], 1u);", ShaderAccess::atomic},
    {"readonly_members", "layout(binding = 0) buffer A { readonly uint x; readonly uint y; } a;",
     "uint x = a.x;", ShaderAccess::read},
};

INSTANTIATE_TEST_SUITE_P(All, ReflectedAccess, testing::ValuesIn(access_cases),
                         [](const auto& param) { return param.param.what; });

struct RuleCase {
    const char* what;
    const char* declarations;
    const char* body;
    const char* message;
};

class BrokenRule : public testing::TestWithParam<RuleCase> {};

TEST_P(BrokenRule, IsAnErrorThatNamesIt) {
    const auto compilation = compile_program(compute(GetParam().declarations, GetParam().body), {});
    ASSERT_FALSE(compilation);
    EXPECT_EQ(compilation.error().kind, ErrorKind::shader);
    EXPECT_THAT(compilation.error().message, HasSubstr(GetParam().message));
}

constexpr const char* needs_qualifier = "declare it readonly, writeonly or LUMO_READ_WRITE";

constexpr RuleCase rule_cases[] = {
    {"unqualified_image", "layout(binding = 0, r32f) uniform image2D a;",
     "imageStore(a, ivec2(0), imageLoad(a, ivec2(1)));", needs_qualifier},
    {"unqualified_image_only_stored", "layout(binding = 0, r32f) uniform image2D a;",
     "imageStore(a, ivec2(0), vec4(1));", needs_qualifier},
    {"unqualified_buffer", "layout(binding = 0) buffer A { uint x; } a;", "a.x = 1u;", needs_qualifier},
    {"unqualified_and_unused", "layout(binding = 0) buffer A { uint x; } a;", "", needs_qualifier},
    {"load_beside_atomics", "layout(binding = 0) buffer A { uint x; } a;", "atomicAdd(a.x, a.x);",
     needs_qualifier},
    {"load_in_a_function",
     "layout(binding = 0, r32ui) uniform uimage2D a;\n"
     "uint get() { return imageLoad(a, ivec2(0)).x; }",
     "imageAtomicAdd(a, ivec2(0), get());", needs_qualifier},
    {"compare_and_swap", "layout(binding = 0) buffer A { uint x; } a;", "atomicCompSwap(a.x, 0u, 1u);",
     needs_qualifier},
    {"exchange", "layout(binding = 0, r32ui) uniform uimage2D a;", "imageAtomicExchange(a, ivec2(0), 1u);",
     needs_qualifier},
    {"qualifiers_that_members_do_not_share",
     "layout(binding = 0) buffer A { readonly uint x; writeonly uint y; } a;", "a.y = a.x;", needs_qualifier},
    {"volatile_buffer", "layout(binding = 0) volatile readonly buffer A { uint x; } a;", "uint x = a.x;",
     "volatile is lost"},
    {"second_set", "layout(set = 1, binding = 0) uniform sampler2D a;", "", "only set 0"},
    {"binding_32", "layout(binding = 32) uniform sampler2D a;", "", "binding 32 is not below 32"},
    {"no_binding", "uniform sampler2D a;", "", "binding"},
    {"separate_texture", "layout(binding = 0) uniform texture2D a;\nlayout(binding = 1) uniform sampler s;",
     "", "'a': textures need a combined sampler"},
    {"separate_sampler", "layout(binding = 1) uniform sampler s;", "", "'s': samplers need to be combined"},
    {"array_of_samplers", "layout(binding = 0) uniform sampler2D a[2];", "", "no arrays of samplers"},
    {"array_of_images", "layout(binding = 0, r32f) readonly uniform image2D a[2];", "",
     "no arrays of samplers"},
    {"array_of_blocks", "layout(binding = 0) readonly buffer A { uint x; } a[2];", "",
     "no arrays of samplers"},
    {"read_without_format",
     "#extension GL_EXT_shader_image_load_formatted : require\n"
     "layout(binding = 0) readonly uniform image2D a;",
     "imageLoad(a, ivec2(0));", "declare the image's format"},
    {"format_that_lumo_lacks", "layout(binding = 0, rgba8_snorm) readonly uniform image2D a;", "",
     "not among rhi::Format"},
    {"buffer_texture", "layout(binding = 0) uniform samplerBuffer a;", "texelFetch(a, 0);", "'a'"},
    {"one_binding_twice",
     "layout(binding = 0) uniform sampler2D a;\nlayout(binding = 0) uniform sampler3D b;",
     "vec4 x = texture(a, vec2(0)) + texture(b, vec3(0));", "not declared alike"},
    {"nine_images",
     "layout(binding = 0, r32f) readonly uniform image2D a;\nlayout(binding = 1, r32f) readonly uniform "
     "image2D b;\n"
     "layout(binding = 2, r32f) readonly uniform image2D c;\nlayout(binding = 3, r32f) readonly uniform "
     "image2D d;\n"
     "layout(binding = 4, r32f) readonly uniform image2D e;\nlayout(binding = 5, r32f) readonly uniform "
     "image2D f;\n"
     "layout(binding = 6, r32f) readonly uniform image2D g;\nlayout(binding = 7, r32f) readonly uniform "
     "image2D h;\n"
     "layout(binding = 8, r32f) readonly uniform image2D i;\n",
     "", "9 storage images"},
    {"float_array_in_push", "layout(push_constant) uniform Push { float a[3]; } push;",
     "float x = push.a[1];", "push constants: a is elsewhere under std140"},
    {"struct_at_8_in_push",
     "struct S { vec2 x; };\nlayout(push_constant) uniform Push { vec2 a; S s; } push;", "vec2 x = push.s.x;",
     "push constants: s is elsewhere under std140"},
    {"big_push", "layout(push_constant) uniform Push { mat4 a; mat4 b; float c; } push;", "float x = push.c;",
     "take 132 bytes"},
    {"uniform_block_of_std430",
     "#extension GL_EXT_scalar_block_layout : require\n"
     "layout(binding = 0, std430) uniform A { float a[3]; } block;",
     "float x = block.a[1];", "not where std140 puts it"},
    {"double_precision", "", "double x = double(gl_GlobalInvocationID.x); if (x > 3.0lf) return;", "Float64"},
    {"subgroups", "#extension GL_KHR_shader_subgroup_arithmetic : require", "uint x = subgroupAdd(1u);",
     "GroupNonUniform"},
    {"group_size_by_option", "layout(local_size_y_id = 4) in;", "", "not local_size_y_id"},
};

INSTANTIATE_TEST_SUITE_P(All, BrokenRule, testing::ValuesIn(rule_cases),
                         [](const auto& param) { return param.param.what; });

TEST(Reflection, RefusesVertexAttributes) {
    const ProgramSource source{
        .name = "test/attribute",
        .stages = {
            {Stages::vertex, "attribute.vert",
             "layout(location = 0) in vec3 position;\nvoid main() { gl_Position = vec4(position, 1); }\n"}}};
    const auto compilation = compile_program(source, {});
    ASSERT_FALSE(compilation);
    EXPECT_THAT(compilation.error().message, HasSubstr("'position': there are no vertex attributes"));
}

TEST(Reflection, RefusesStagesThatDisagree) {
    const auto program = [](const std::string& in_vertex, const std::string& in_fragment) {
        return ProgramSource{
            .name = "test/two",
            .stages = {{Stages::vertex, "two.vert", in_vertex + "\nvoid main() { gl_Position = vec4(0); }\n"},
                       {Stages::fragment, "two.frag",
                        in_fragment + "\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n"}}};
    };
    const auto message = [&](const std::string& in_vertex, const std::string& in_fragment) {
        const auto compilation = compile_program(program(in_vertex, in_fragment), {});
        return compilation ? std::string("no error") : compilation.error().message;
    };
    const std::string texture = "layout(binding = 1) uniform sampler2D a;";
    EXPECT_EQ(message(texture, texture), "no error");
    EXPECT_THAT(message(texture, "layout(binding = 1) uniform sampler2D b;"),
                HasSubstr("not declared alike"));
    EXPECT_THAT(message(texture, "layout(binding = 2) uniform sampler2D a;"),
                HasSubstr("binding qualifier must match"));
    EXPECT_THAT(message("layout(binding = 1) readonly buffer B { uint x; } a;",
                        "layout(binding = 1) writeonly buffer B { uint x; } a;"),
                HasSubstr("readonly qualifier must match"));
    EXPECT_THAT(message("layout(binding = 1) readonly buffer B { uint x; } a;",
                        "layout(binding = 2) readonly buffer B { uint x; } b;"),
                HasSubstr("binding qualifier must match"));
    EXPECT_THAT(message("layout(push_constant) uniform Push { float a; } push;",
                        "layout(push_constant) uniform Push { int a; } push;"),
                Not(HasSubstr("no error")));
    EXPECT_THAT(
        message("layout(constant_id = 0) const int n = 1;", "layout(constant_id = 0) const int n = 2;"),
        HasSubstr("constant_id 0"));
    EXPECT_THAT(message("layout(location = 0) out vec3 v;", "layout(location = 0) in vec4 v;"),
                HasSubstr("Types must match"));
}

}  // namespace
}  // namespace lumo::shadercompiler
