// Whole frames in a host's OpenGL context, whose state is nowhere the default.
#include "backends/gl/adopt.hpp"
#include "samples/embed-gl/state_dump.hpp"
#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/adopt/gl_host.hpp"
#include "tests/support/device_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using testing::IsEmpty;

struct AdoptGlFrame : testing::TestWithParam<voxels::Storage> {};
INSTANTIATE_TEST_SUITE_P(Storage, AdoptGlFrame,
                         testing::Values(voxels::Storage::dense, voxels::Storage::octree),
                         [](const auto& info) {
                             return info.param == voxels::Storage::dense ? "dense" : "octree";
                         });

TEST_P(AdoptGlFrame, IsTheSameToTheBitAsOnADeviceOfLumosOwn) {
    const scene::Scene scene = must(scene::make_builtin("cornell"));
    frame::Settings settings{.size = {96, 64}};
    settings.voxels.resolution = 32;
    settings.voxels.storage = GetParam();
    settings.layers = {frame::Layer::radiance, frame::Layer::irradiance};
    const scene::Camera camera = scene.cameras.at(0);
    frame::Rendered own;
    {
        auto checked = open_device(rhi::Api::gl);
        if (!checked) GTEST_SKIP() << "there is no OpenGL device";
        own = must(frame::render(*checked->device, scene, camera, settings));
    }
    const auto host = GlHost::make();
    ASSERT_TRUE(host);
    set_unusual_state();
    const embed::StateDump before = embed::dump_state();
    std::vector<rhi::Message> messages;
    {
        rhi::Device device = must(backends::gl::adopt_current_context(
            {.validation = true, .sink = [&](const rhi::Message& message) { messages.push_back(message); }}));
        const frame::Rendered adopted = must(frame::render(device, scene, camera, settings));
        EXPECT_THAT(embed::differences(before, embed::dump_state()), IsEmpty());
        ASSERT_EQ(adopted.layers.size(), 2u);
        double sum = 0;
        for (size_t i = 0; i < adopted.layers.size(); ++i) {
            EXPECT_EQ(adopted.layers[i].linear.values, own.layers[i].linear.values);
            for (float value : adopted.layers[i].linear.values) sum += value;
        }
        EXPECT_GT(sum, 0) << "a black picture shows nothing";
    }
    EXPECT_THAT(embed::differences(before, embed::dump_state()), IsEmpty()) << "after the device went";
    for (const rhi::Message& message : messages) EXPECT_FALSE(is_failure(message)) << message.text;
}

}  // namespace
}  // namespace lumo
