// Whole frames on a host's Vulkan device, without push descriptors and with what is required alone.
#include "backends/vulkan/adopt.hpp"
#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/adopt/vulkan_host.hpp"
#include "tests/support/device_test.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using testing::IsEmpty;

TEST(AdoptVulkanFrame, IsTheSameToTheBitAsOnADeviceOfLumosOwn) {
    auto host = VulkanHost::open({});
    if (!host) GTEST_SKIP() << "there is no Vulkan device";
    const auto said = host->messages();
    auto own = open_device(rhi::Api::vulkan, {.name = host->device_name()});
    ASSERT_TRUE(own);
    std::vector<rhi::Message> messages;
    {
        // Overlapped: no barrier but those of the plan stands between passes, so the layers see what it forgets.
        rhi::Device adopted = must(backends::vulkan::adopt_device(
            host->described(), {.timing = rhi::Timing::overlapped,
                                .sink = [&](const rhi::Message& message) { messages.push_back(message); }}));
        const scene::Scene scene = must(scene::make_builtin("cornell"));
        frame::Settings settings{.size = {96, 64}};
        settings.voxels.resolution = 32;
        settings.layers = {frame::Layer::radiance, frame::Layer::irradiance};
        const scene::Camera camera = scene.cameras.at(0);
        const frame::Rendered here = must(frame::render(adopted, scene, camera, settings));
        const frame::Rendered there = must(frame::render(*own->device, scene, camera, settings));
        ASSERT_EQ(here.layers.size(), 2u);
        double sum = 0;
        for (size_t i = 0; i < here.layers.size(); ++i) {
            EXPECT_EQ(here.layers[i].linear.values, there.layers[i].linear.values);
            for (float value : here.layers[i].linear.values) sum += value;
        }
        EXPECT_GT(sum, 0) << "a black picture shows nothing";
    }
    host.reset();
    EXPECT_THAT(*said, IsEmpty());
    for (const rhi::Message& message : messages) EXPECT_FALSE(is_failure(message)) << message.text;
    EXPECT_THAT(own->take_failures(), IsEmpty());
}

}  // namespace
}  // namespace lumo
