// lumo render --capture, with RenderDoc's library and without.
#include <cstdlib>

#include "program.hpp"

namespace lumo::test {
namespace {

class Capture : public Program {
  protected:
    static Arguments render(const std::string& api, const std::string& picture) {
        return {"render", "cornell", "--api", api, "--size", "32x32", "--voxels", "16", "-o", picture};
    }
    static Arguments with_capture(Arguments arguments) {
        arguments.insert(arguments.end(), {"--capture", "frame.rdc"});
        return arguments;
    }
    /// As `renderdoccmd capture` starts it. A debug context of its own is RenderDoc's business then.
    Outcome under_renderdoc(const Arguments& arguments) const {
        return lumo(
            arguments,
            {{"LD_PRELOAD", library}, {"ENABLE_VULKAN_RENDERDOC_CAPTURE", "1"}, {"LUMO_VALIDATION", "0"}});
    }
    static constexpr const char* library = "librenderdoc.so";
};
class CaptureOnApi : public Capture, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Program, CaptureOnApi, testing::Values("gl", "vulkan"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(CaptureOnApi, HoldsTheCallsOfAFrameUnderTheirPasses) {
    if (std::system("renderdoccmd version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "RenderDoc is not installed (Debian's renderdoccmd)";
    const Outcome run = under_renderdoc(with_capture(render(GetParam(), "captured.png")));
    if (contains(run.err, "Vulkan 1.3"))
        GTEST_SKIP() << "RenderDoc shows Vulkan 1.3 only of devices with bufferDeviceAddressCaptureReplay: "
                     << run.err;
    ASSERT_EQ(run.exit_code, 0) << run.err;
    ASSERT_TRUE(std::filesystem::exists(path("frame.rdc"))) << run.err;

    const std::string convert = "renderdoccmd convert -f '" + path("frame.rdc").string() + "' -o '" +
                                path("frame.xml").string() + "' -c xml >/dev/null 2>&1";
    ASSERT_EQ(std::system(convert.c_str()), 0) << "it opens";
    const std::string calls = bytes("frame.xml");
    EXPECT_TRUE(contains(calls, std::string(GetParam()) == "gl" ? "glDispatchCompute" : "vkCmdDispatch"));
    for (const char* pass : {"gbuffer", "shadow", "voxels"}) EXPECT_TRUE(contains(calls, pass)) << pass;

    done(render(GetParam(), "plain.png"));
    EXPECT_EQ(bytes("captured.png"), bytes("plain.png"));
}

TEST_F(Capture, SaysHowToRunWhereRenderDocIsNotLoaded) {
    const Outcome run = lumo(with_capture(render("gl", "x.png")));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(contains(run.err, "renderdoccmd capture")) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("frame.rdc")));
}

TEST_F(Capture, IsOfOneDevice) {
    const Outcome run = lumo(with_capture(render("both", "x.png")));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(lines(run.err), 1) << run.err;
    EXPECT_TRUE(contains(run.err, "--api")) << run.err;
}

}  // namespace
}  // namespace lumo::test
