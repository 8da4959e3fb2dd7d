#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shadercompiler/program_code.hpp"
#include "tests/unit/shadercompiler_fixture.hpp"

namespace lumo::shadercompiler {
namespace {

namespace fs = std::filesystem;
using rhi::Stages;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string message_of(const Result<Compilation>& compilation) {
    return compilation ? "no error" : compilation.error().message;
}

TEST(Errors, NameTheLineOfTheSource) {
    const ProgramSource source{
        .name = "a/b",
        .stages = {{Stages::compute, "shaders/a/b.comp",
                    "layout(local_size_x = 1) in;\n\nvoid main() {\n    float x = missing;\n}\n"}}};
    const auto compilation = compile_program(source, {.defines = {{"ONE", "1"}, {"TWO", "2"}}});
    ASSERT_FALSE(compilation);
    EXPECT_EQ(compilation.error().kind, ErrorKind::shader);
    EXPECT_EQ(compilation.error().subject, "a/b");
    EXPECT_THAT(compilation.error().message, HasSubstr("\nshaders/a/b.comp:4: error: 'missing'"));
    EXPECT_THAT(compilation.error().message, Not(HasSubstr("compilation")));
}

TEST(Errors, NameTheLineInIncludedFilesAndAfterThem) {
    const TemporaryFolder folder;
    const auto compile = [&](const std::string& in_inner, const std::string& in_outer,
                             const std::string& after) {
        folder.write("common/inner.glsl", "// one\n// two\nconst float inner = " + in_inner + ";");
        folder.write("common/outer.glsl",
                     "\n#include \"common/inner.glsl\"\nconst float outer = " + in_outer + ";\n");
        return message_of(
            compile_program(compute("#include \"common/outer.glsl\"\nconst float after = " + after + ";", ""),
                            {.include_roots = {folder.path()}}));
    };
    const std::string path = folder.path().string();
    EXPECT_EQ(compile("1", "inner", "outer"), "no error");
    EXPECT_THAT(compile("gone", "1", "1"), StartsWith("\n" + path + "/common/inner.glsl:3: error: 'gone'"));
    EXPECT_THAT(compile("1", "lost", "1"), StartsWith("\n" + path + "/common/outer.glsl:3: error: 'lost'"));
    EXPECT_THAT(compile("1", "1", "nowhere"), StartsWith("\none.comp:3: error: 'nowhere'"));
}

TEST(Errors, NameAnIncludeThatIsNotThere) {
    const std::string message = message_of(
        compile_program(compute("#include \"a/b.glsl\"", ""), {.include_roots = {"/nonexistent"}}));
    EXPECT_THAT(message, HasSubstr("one.comp:2: error:"));
    EXPECT_THAT(message, HasSubstr("no \"a/b.glsl\" in the include roots (/nonexistent)"));
    EXPECT_THAT(message_of(compile_program(compute("#include <a.glsl>", ""), {})),
                HasSubstr("<> is not searched"));
}

TEST(Errors, NameTheDeclarationThatBreaksARule) {
    const TemporaryFolder folder;
    const std::string include =
        folder
            .write("b.glsl",
                   "// one\nlayout(binding = 1, std430) buffer Numbers {\n    uint n[];\n} numbers;\n")
            .string();
    const ProgramSource source =
        compute("#include \"b.glsl\"\n\nlayout(binding = 0, r32f) uniform image2D picture;",
                "imageStore(picture, ivec2(0), vec4(numbers.n[0]));");
    const std::string message = message_of(compile_program(source, {.include_roots = {folder.path()}}));
    EXPECT_THAT(message, HasSubstr("\none.comp:4: error: 'picture': declare"));
    EXPECT_THAT(message, HasSubstr("\n" + include + ":2: error: 'numbers': declare"));
}

TEST(Includes, AreReadOnceFromTheFirstRootThatHasThem) {
    const TemporaryFolder first;
    const TemporaryFolder second;
    const fs::path both = first.write("both.glsl", "const float both = 1;");
    second.write("both.glsl", "this is not GLSL");
    const fs::path other =
        second.write("folder/other.glsl", "#include \"both.glsl\"\nconst float other = both;\n");
    const auto compilation = compile_program(
        compute("#include \"both.glsl\"\n#include \"folder/other.glsl\"\n#include \"both.glsl\"",
                "float x = other;"),
        {.include_roots = {first.path(), second.path()}});
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    ASSERT_EQ(compilation->includes.size(), 2u);
    EXPECT_EQ(compilation->includes[0].path, both);
    EXPECT_EQ(compilation->includes[1].path, other);
}

TEST(Includes, OfThemselvesEnd) {
    const TemporaryFolder folder;
    folder.write("self.glsl", "#include \"self.glsl\"\nconst float self = 1;\n");
    const auto compilation = compile_program(compute("#include \"self.glsl\"", "float x = self;"),
                                             {.include_roots = {folder.path()}});
    EXPECT_TRUE(compilation) << to_string(compilation.error());
}

TEST(Defines, ReachTheSource) {
    const ProgramSource source = compute("#ifndef SIZE\n#error no size\n#endif", "float x[SIZE]; x[1] = 0;");
    EXPECT_THAT(message_of(compile_program(source, {})), HasSubstr("no size"));
    const auto compilation = compile_program(source, {.defines = {{"SIZE", "2"}}});
    EXPECT_TRUE(compilation) << to_string(compilation.error());
}

TEST(Programs, AreReadFromTheirFiles) {
    const auto source = find_program(data_root, "unit_shaders/raster");
    ASSERT_TRUE(source) << to_string(source.error());
    EXPECT_EQ(source->name, "unit_shaders/raster");
    ASSERT_EQ(source->stages.size(), 3u);
    EXPECT_EQ(source->stages[1].stage, Stages::geometry);
    EXPECT_THAT(source->stages[1].text, StartsWith("#include"));

    EXPECT_EQ(find_program(data_root, "unit_shaders/none").error().kind, ErrorKind::io);
    const TemporaryFolder folder;
    const fs::path vertex = folder.write("a/b.vert", "");
    const fs::path fragment = folder.write("a/b.frag", "");
    const fs::path compute = folder.write("a/b.comp", "");
    const fs::path other = folder.write("a/c.frag", "");
    const fs::path text = folder.write("a/b.txt", "");
    const auto kind = [&](const std::vector<fs::path>& files) {
        const auto program = read_program(folder.path(), files);
        return program ? "read" : program.error().kind == ErrorKind::invalid_argument ? "invalid" : "other";
    };
    EXPECT_STREQ(kind({vertex}), "read");
    EXPECT_STREQ(kind({fragment, vertex}), "read");
    EXPECT_STREQ(kind({compute}), "read");
    EXPECT_STREQ(kind({fragment}), "invalid");
    EXPECT_STREQ(kind({compute, vertex}), "invalid");
    EXPECT_STREQ(kind({vertex, other}), "invalid");
    EXPECT_STREQ(kind({vertex, text}), "invalid");
    EXPECT_STREQ(kind({}), "invalid");
    EXPECT_STREQ(kind({folder.path() / "a/none.vert"}), "other");
}

std::string opengl_text(const Compilation& compilation, Stages stage) {
    const auto stages = compilation.program.info().stages;
    const auto it = std::ranges::find(stages, stage, &rhi::StageInfo::stage);
    return it == stages.end() ? "no such stage" : std::string(it->glsl);
}

TEST(OpenGl, TextHasTheSlotsOfTheReflection) {
    for (const bool optimise : {true, false}) {
        const auto compilation = compile_data("unit_shaders/everything", {.optimise = optimise});
        ASSERT_TRUE(compilation) << to_string(compilation.error());
        const std::string text = opengl_text(*compilation, Stages::compute);
        EXPECT_THAT(text, StartsWith("#version 450\n"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 0) uniform sampler3D radiance;"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 1) uniform usampler2DArray codes;"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 0, r32ui) uniform uimage3D counts;"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 1, rgba16f) uniform writeonly image2D result;"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 0, std430) readonly buffer Samples"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 1, std430) restrict buffer State"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 2, std430) buffer Totals"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 1, std140) uniform Lights"));
        EXPECT_THAT(text, HasSubstr("layout(binding = 0, std140) uniform Push"));
        EXPECT_THAT(text, Not(HasSubstr("set =")));
        EXPECT_THAT(text, Not(HasSubstr("count_at"))) << "Mesa refuses image atomics through parameters";
    }
}

TEST(OpenGl, OptionsAreMacros) {
    const auto compilation = compile_data("unit_shaders/everything");
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    const std::string text = opengl_text(*compilation, Stages::compute);
    for (const int id : {2, 4, 5, 7}) {
        EXPECT_THAT(text, HasSubstr("#ifndef SPIRV_CROSS_CONSTANT_ID_" + std::to_string(id)));
    }
    EXPECT_THAT(text, HasSubstr("const bool fast = SPIRV_CROSS_CONSTANT_ID_2;"));
    EXPECT_THAT(text, HasSubstr("const int bias = SPIRV_CROSS_CONSTANT_ID_4;"));
    EXPECT_THAT(text, HasSubstr("const uint count = SPIRV_CROSS_CONSTANT_ID_5;"));
    EXPECT_THAT(text, HasSubstr("const float scale = SPIRV_CROSS_CONSTANT_ID_7;"));
}

TEST(OpenGl, RasterStagesNeedNothingBesidesTheirBindings) {
    const auto compilation = compile_data("unit_shaders/raster");
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    const std::string vertex = opengl_text(*compilation, Stages::vertex);
    EXPECT_THAT(vertex, HasSubstr("gl_InstanceID"));
    EXPECT_THAT(vertex, HasSubstr("gl_VertexID"));
    EXPECT_THAT(vertex, HasSubstr("gl_PointSize"));
    EXPECT_THAT(vertex, Not(HasSubstr("BaseInstance")));
    EXPECT_THAT(vertex, Not(HasSubstr("unused"))) << "the optimised code lacks what nothing uses";
    EXPECT_THAT(opengl_text(*compilation, Stages::geometry), HasSubstr("gl_Layer"));
    const std::string fragment = opengl_text(*compilation, Stages::fragment);
    EXPECT_THAT(fragment, HasSubstr("layout(location = 2) out uint index;"));
    EXPECT_THAT(fragment, HasSubstr("layout(binding = 1) uniform sampler2DShadow shadow;"));
}

TEST(OpenGl, PreciseStaysPrecise) {
    const auto compilation =
        compile_program(compute("layout(binding = 0) writeonly buffer A { float x; } a;\n"
                                "layout(binding = 1) readonly buffer B { float x, y, z; } b;",
                                "precise float sum = b.x * b.y + b.z; a.x = sum;"),
                        {});
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    EXPECT_THAT(opengl_text(*compilation, Stages::compute), HasSubstr("precise float"));
}

TEST(OpenGl, ReadonlyIsNotGuessed) {
    // Reflection calls it read and write; text that said readonly would disagree with the barriers.
    const auto compilation =
        compile_program(compute("layout(binding = 0, r32f) LUMO_READ_WRITE uniform image2D a;\n"
                                "layout(binding = 1) writeonly buffer B { float x; } b;",
                                "b.x = imageLoad(a, ivec2(0)).x;"),
                        {});
    ASSERT_TRUE(compilation) << to_string(compilation.error());
    EXPECT_THAT(opengl_text(*compilation, Stages::compute), HasSubstr("uniform restrict image2D a;"));
}

TEST(Code, IsTheSameEveryTimeAndHashedByContent) {
    const auto first = compile_data("unit_shaders/everything");
    const auto second = compile_data("unit_shaders/everything");
    const auto plain = compile_data("unit_shaders/everything", {.optimise = false});
    ASSERT_TRUE(first && second && plain);
    EXPECT_EQ(to_bytes(first->program.code()), to_bytes(second->program.code()));
    EXPECT_EQ(first->program.info().hash, second->program.info().hash);
    EXPECT_NE(first->program.info().hash, plain->program.info().hash);
}

class Cache : public testing::Test {
  protected:
    Result<CompiledProgram> compile(const std::string& define = "1") const {
        return compile_program(source, {.include_roots = {folder.path()}, .defines = {{"VALUE", define}}},
                               cache);
    }

    std::vector<fs::path> entries() const {
        std::vector<fs::path> paths;
        if (!fs::exists(cache.folder())) return paths;
        for (const auto& entry : fs::directory_iterator(cache.folder())) paths.push_back(entry.path());
        return paths;
    }

    TemporaryFolder folder;
    rhi::DiskCache cache{folder.path() / "cache"};
    fs::path include = folder.write("number.glsl", "const float number = 3;");
    ProgramSource source = compute(
        "#include \"number.glsl\"\nlayout(binding = 4) writeonly buffer Out { float x; } result;\n"
        "layout(push_constant) uniform Push { float f; } push;\nlayout(constant_id = 3) const float s = 1;",
        "result.x = number * VALUE * s + push.f;");
};

TEST_F(Cache, GivesBackWhatWasCompiled) {
    const auto compiled = compile();
    ASSERT_TRUE(compiled) << to_string(compiled.error());
    ASSERT_EQ(entries().size(), 1u);
    const auto direct =
        compile_program(source, {.include_roots = {folder.path()}, .defines = {{"VALUE", "1"}}});
    const auto cached = compile();
    ASSERT_TRUE(direct && cached);
    EXPECT_EQ(to_bytes(cached->code()), to_bytes(direct->program.code()));
    EXPECT_EQ(cached->info().hash, direct->program.info().hash);
    EXPECT_EQ(cached->info().name, "test/one");
    ASSERT_EQ(cached->info().bindings.size(), 1u);
    EXPECT_EQ(cached->info().bindings[0].name, "result");
    ASSERT_EQ(cached->info().options.size(), 1u);
    EXPECT_EQ(cached->info().options[0].name, "s");
}

TEST_F(Cache, IsUsedInsteadOfTheCompiler) {
    ASSERT_TRUE(compile());
    // An entry whose bytes are those of another program: if they come back, nothing was compiled.
    const auto other = compile_program(compute("", ""), {});
    ASSERT_TRUE(other);
    const CompileOptions options{.include_roots = {folder.path()}, .defines = {{"VALUE", "1"}}};
    ASSERT_TRUE(cache.put(cache_key(source, options), cache_entry(*other)));
    const auto cached = compile();
    ASSERT_TRUE(cached);
    EXPECT_EQ(cached->info().hash, other->program.info().hash);
}

TEST_F(Cache, SeesChangesOfSourcesIncludesAndDefines) {
    const auto original = compile();
    ASSERT_TRUE(original);
    const auto defined = compile("2");
    ASSERT_TRUE(defined);
    EXPECT_NE(defined->info().hash, original->info().hash);

    folder.write("number.glsl", "const float number = 4;");
    const auto included = compile();
    ASSERT_TRUE(included);
    EXPECT_NE(included->info().hash, original->info().hash);

    source.stages[0].text += "\n// a comment\n";
    const size_t count = entries().size();
    ASSERT_TRUE(compile());
    EXPECT_EQ(entries().size(), count + 1);

    fs::remove(include);
    EXPECT_FALSE(compile());
}

TEST_F(Cache, IgnoresEntriesThatAreNotPrograms) {
    ASSERT_TRUE(compile());
    const CompileOptions options{.include_roots = {folder.path()}, .defines = {{"VALUE", "1"}}};
    const rhi::CacheKey key = cache_key(source, options);
    const auto good = cache.get(key);
    ASSERT_TRUE(good);
    for (const size_t size : {size_t(0), size_t(7), size_t(40), good->size() / 2, good->size() - 1}) {
        ASSERT_TRUE(cache.put(key, std::span(*good).first(size)));
        const auto compiled = compile();
        ASSERT_TRUE(compiled) << size;
        EXPECT_EQ(cache.get(key), good) << "rewritten after " << size << " bytes";
    }
}

TEST_F(Cache, IsNotNeeded) {
    const rhi::DiskCache nowhere{fs::path()};
    const auto compiled =
        compile_program(source, {.include_roots = {folder.path()}, .defines = {{"VALUE", "1"}}}, nowhere);
    EXPECT_TRUE(compiled);
}

}  // namespace
}  // namespace lumo::shadercompiler
