// The sample embed-vulkan as its users run it: the host is as it was, and lit.
#include "backends/backends.hpp"
#include "tests/support/sample.hpp"

namespace lumo {
namespace {

using testing_support::picture_of_sample;
using testing_support::pixel;

TEST(EmbedVulkan, IsLitByLumoAndLeftAsItWas) {
    if (backends::list_devices(rhi::Api::vulkan).empty()) GTEST_SKIP() << "there is no Vulkan device";
    // Every message of the validation layers makes it fail.
    const scene::Image8 lit = picture_of_sample(LUMO_EMBED_VULKAN, "--validation --check --frames 3"),
                        alone = picture_of_sample(LUMO_EMBED_VULKAN, "--validation --no-gi");
    ASSERT_EQ(lit.values.size(), 160u * 90 * 4);
    ASSERT_EQ(alone.values.size(), lit.values.size());
    const std::array<int, 3> black{0, 0, 0};

    // The sky and the host's own triangle are not lumo's matter.
    EXPECT_EQ(pixel(lit, 0.5, 0.05), pixel(alone, 0.5, 0.05));
    EXPECT_EQ(pixel(lit, 0.08, 0.9), pixel(alone, 0.08, 0.9));
    EXPECT_NE(pixel(lit, 0.08, 0.9), pixel(lit, 0.02, 0.9));

    // In the shadow of the box, on the right wall, and on the floor beside that wall.
    for (const auto& [x, y] : {std::pair(0.48, 0.68), {0.92, 0.4}, {0.85, 0.85}}) {
        EXPECT_EQ(pixel(alone, x, y), black) << x << ", " << y;
        EXPECT_NE(pixel(lit, x, y), black) << x << ", " << y;
    }
    // Light takes on the colour of what it comes from: in the shadow of the tall box that of the sunlit red wall, and
    // beside the green wall, which the sun does not see, that of the sky.
    EXPECT_EQ(pixel(alone, 0.26, 0.59), black) << "the tall box's shadow";
    const auto left = pixel(lit, 0.26, 0.59), right = pixel(lit, 0.85, 0.85);
    EXPECT_GT(left[0], left[1] + 20);
    EXPECT_GT(left[0], left[2] + 20);
    EXPECT_GT(right[2], right[0]);
}

}  // namespace
}  // namespace lumo
