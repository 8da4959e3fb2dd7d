// What the program does where its device or its disk is not as it was promised.
#include "program.hpp"

#include "tests/support/full_disk.hpp"

namespace lumo::test {
namespace {

const Arguments small_picture{"render", "cornell", "--size", "32x32", "--voxels", "16", "--quiet"};

Arguments with(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

class Faults : public ProgramOnApi {};
INSTANTIATE_TEST_SUITE_P(Apis, Faults, testing::Values("gl", "vulkan"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(Faults, ADeviceThatAnotherWouldAnswerForIsRefused) {
    const auto found = nlohmann::json::parse(done({"devices", "--json"}).out, nullptr, false);
    ASSERT_FALSE(found.is_discarded());
    const Outcome run =
        lumo(with(small_picture, {"--api", GetParam(), "--device", "Quantum 9000", "-o", "picture.png"}));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(lines(run.err), 1) << run.err;
    EXPECT_TRUE(contains(run.err, "Quantum 9000")) << run.err;
    EXPECT_TRUE(contains(run.err, "found: ")) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("picture.png")));
}

TEST_P(Faults, ANamedDeviceIsTheOneThatDraws) {
    done(with(small_picture, {"--api", GetParam(), "-o", "any.png", "--stats", "any.json"}));
    const std::string name = json("any.json")["device"].get<std::string>().substr(0, 6);
    done(
        with(small_picture, {"--api", GetParam(), "--device", name, "-o", "one.png", "--stats", "one.json"}));
    EXPECT_EQ(json("one.json")["device"], json("any.json")["device"]);
    EXPECT_EQ(bytes("one.png"), bytes("any.png"));
}

TEST_P(Faults, APictureThatDoesNotFitOnItsDiskIsAnErrorThatNamesIt) {
    const auto disk = testing_support::FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    disk->fill();
    for (const char* name : {"picture.png", "picture.exr"}) {
        const std::string file = disk->folder() / name;
        const Outcome run = lumo(with(small_picture, {"--api", GetParam(), "-o", file}));
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, file)) << run.err;
        EXPECT_TRUE(contains(run.err, "room")) << run.err;
        EXPECT_FALSE(std::filesystem::exists(file)) << "half a picture";
    }
}

TEST_P(Faults, ACacheThatCannotBeWrittenIsNoFailure) {
    const auto disk = testing_support::FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    disk->fill();
    // Mesa's own cache elsewhere: on a full disk it ends the process.
    const std::string mesa = std::filesystem::temp_directory_path() / "lumo-test-mesa";
    done(with(small_picture, {"--api", GetParam(), "-o", "right.png"}));
    for (const std::string& cache : {disk->folder().string(), std::string("/proc/none")}) {
        const Outcome run = lumo(with(small_picture, {"--api", GetParam(), "-o", "picture.png"}),
                                 {{"XDG_CACHE_HOME", cache}, {"MESA_SHADER_CACHE_DIR", mesa}});
        EXPECT_EQ(run.exit_code, 0) << run.err;
        EXPECT_EQ(run.err, "");
        EXPECT_EQ(bytes("picture.png"), bytes("right.png"));
    }
}

class Output : public Program {};

TEST_F(Output, ThatDoesNotFitIsAFailure) {
    const auto disk = testing_support::FullDisk::mount();
    if (!disk) GTEST_SKIP() << "this user may not mount a small disk";
    std::filesystem::create_symlink(disk->folder() / "out", path(".out"));
    disk->fill();
    for (const Arguments& arguments : {Arguments{"devices", "--json"}, Arguments{"--version"}}) {
        const Outcome run = lumo(arguments);
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, "standard output")) << run.err;
    }
    disk->empty();
    EXPECT_EQ(lumo({"--version"}).exit_code, 0);
}

}  // namespace
}  // namespace lumo::test
