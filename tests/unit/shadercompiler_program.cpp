// lumo_shaderc as the build runs it.
#include <array>
#include <chrono>
#include <cstdio>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <sys/wait.h>

#include "tests/unit/shadercompiler_fixture.hpp"

namespace lumo::shadercompiler {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Outcome {
    int exit_code = -1;
    std::string output;  // of both streams
};

Outcome shaderc(const std::string& arguments) {
    Outcome outcome;
    std::FILE* pipe = ::popen((std::string(LUMO_SHADERC) + " " + arguments + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return outcome;
    std::array<char, 4096> chunk;
    while (const size_t size = std::fread(chunk.data(), 1, chunk.size(), pipe))
        outcome.output.append(chunk.data(), size);
    const int status = ::pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class Shaderc : public testing::Test {
  protected:
    Outcome compile(const std::string& more = "") const {
        return shaderc("--root " + (folder.path() / "in").string() + " -o " + out.string() + " --depfile " +
                       (out / "one.d").string() + " " + source.string() + " " + more);
    }

    TemporaryFolder folder;
    fs::path out = folder.path() / "out";
    fs::path include = folder.write("in/common/half.glsl", "const float one_half = 0.5;\n");
    fs::path source = folder.write("in/test/one.comp",
                                   "#include \"common/half.glsl\"\nlayout(local_size_x = 4) in;\n"
                                   "layout(binding = 1) writeonly buffer Out { float x; } result;\n"
                                   "void main() { result.x = one_half; }\n");
};

TEST_F(Shaderc, WritesHeaderSourceAndDependencies) {
    const Outcome outcome = compile();
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.output, "");
    EXPECT_THAT(read(out / "shaders/test/one.hpp"), HasSubstr("rhi::StorageBuffer result;"));
    EXPECT_THAT(read(out / "shaders/test/one.cpp"), HasSubstr("one::info()"));
    const std::string dependencies = read(out / "one.d");
    EXPECT_THAT(dependencies, HasSubstr((out / "shaders/test/one.cpp").string() + ":"));
    EXPECT_THAT(dependencies, HasSubstr(source.string()));
    EXPECT_THAT(dependencies, HasSubstr(include.string()));
}

TEST_F(Shaderc, DoesNotTouchAHeaderThatStaysTheSame) {
    ASSERT_EQ(compile().exit_code, 0);
    const fs::path header = out / "shaders/test/one.hpp";
    const fs::path code = out / "shaders/test/one.cpp";
    const auto long_ago = fs::last_write_time(header) - std::chrono::hours(1);
    fs::last_write_time(header, long_ago);
    fs::last_write_time(code, long_ago);
    folder.write("in/common/half.glsl", "const float one_half = 0.25;\n");
    ASSERT_EQ(compile().exit_code, 0);
    EXPECT_EQ(fs::last_write_time(header), long_ago);
    EXPECT_GT(fs::last_write_time(code), long_ago);
}

TEST_F(Shaderc, SaysWhereAFaultIsAndWritesNothing) {
    folder.write("in/common/half.glsl", "\nconst float one_half = third;\n");
    const Outcome outcome = compile();
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr(include.string() + ":2: error: 'third'"));
    EXPECT_FALSE(fs::exists(out));
}

TEST_F(Shaderc, TakesDefinesAndFurtherFoldersForIncludes) {
    folder.write("more/more.glsl", "const float more = MORE;\n");
    folder.write("in/test/one.comp",
                 "#include \"more.glsl\"\nlayout(local_size_x = 4) in;\nvoid main() {}\n");
    EXPECT_NE(compile().exit_code, 0);
    EXPECT_NE(compile("-I " + (folder.path() / "more").string()).exit_code, 0);
    const Outcome outcome = compile("-I " + (folder.path() / "more").string() + " -D MORE=2.0");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
}

TEST_F(Shaderc, FailsWhereItCannotWrite) {
    std::ofstream(out) << "a file in the way";
    const Outcome outcome = compile();
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("one.hpp: cannot be written"));
}

}  // namespace
}  // namespace lumo::shadercompiler
