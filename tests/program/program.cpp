#include "program.hpp"

#include <algorithm>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

namespace lumo::test {
namespace {

std::string read(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// In the child process: becomes the program, or ends.
[[noreturn]] void become(std::vector<char*>& argv, const std::filesystem::path& folder,
                         const Environment& environment) {
    const auto redirect = [](const char* name, int descriptor) {
        const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        return file >= 0 && dup2(file, descriptor) >= 0;
    };
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    if (chdir(folder.c_str()) == 0 && redirect(".out", STDOUT_FILENO) && redirect(".err", STDERR_FILENO))
        execv(LUMO_PROGRAM, argv.data());
    _exit(127);
}

}  // namespace

void Program::SetUp() {
    std::string name =
        fmt::format("lumo-{}-{}", getpid(), testing::UnitTest::GetInstance()->current_test_info()->name());
    std::ranges::replace(name, '/', '-');
    folder_ = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::create_directories(folder_);
}

void Program::TearDown() { std::filesystem::remove_all(folder_); }

Outcome Program::lumo(const Arguments& arguments, const Environment& environment) const {
    Environment all{{"XDG_CACHE_HOME", LUMO_TEST_CACHE}, {"LUMO_VALIDATION", "1"}};
    std::ranges::copy(environment, std::back_inserter(all));
    std::vector<std::string> words{"lumo"};
    std::ranges::copy(arguments, std::back_inserter(words));
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    const pid_t child = fork();
    if (child == 0) become(argv, folder_, all);
    int status = 0;
    waitpid(child, &status, 0);
    return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            .out = read(folder_ / ".out"),
            .err = read(folder_ / ".err")};
}

Outcome Program::done(const Arguments& arguments) const {
    Outcome run = lumo(arguments);
    EXPECT_EQ(run.exit_code, 0) << testing::PrintToString(arguments) << "\n" << run.err << run.out;
    return run;
}

void Program::write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
}

nlohmann::json Program::json(const std::string& name) const {
    return nlohmann::json::parse(bytes(name), nullptr, false);
}

scene::Image8 Program::png(const std::string& name) const {
    auto image = scene::read_image8(path(name));
    EXPECT_TRUE(image) << to_string(image.error());
    return image ? *image : scene::Image8{};
}

std::vector<scene::ExrLayer> Program::exr(const std::string& name) const {
    auto layers = scene::read_exr(path(name));
    EXPECT_TRUE(layers) << to_string(layers.error());
    return layers ? *layers : std::vector<scene::ExrLayer>{};
}

std::string Program::bytes(const std::string& name) const { return read(path(name)); }

size_t lines(const std::string& text) { return size_t(std::ranges::count(text, '\n')); }

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace lumo::test
