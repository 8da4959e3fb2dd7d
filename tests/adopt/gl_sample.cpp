// The sample embed-gl as its users run it: the host's state is as it was, the driver silent, the picture lit.
#include "backends/backends.hpp"
#include "tests/support/sample.hpp"

namespace lumo {
namespace {

using testing_support::picture_of_sample;
using testing_support::pixel;

TEST(EmbedGl, IsLitByLumoAndFindsItsState) {
    if (backends::list_devices(rhi::Api::gl).empty()) GTEST_SKIP() << "there is no OpenGL device";
    const scene::Image8 lit = picture_of_sample(LUMO_EMBED_GL, "--check-state --frames 3"),
                        alone = picture_of_sample(LUMO_EMBED_GL, "--no-gi");
    ASSERT_EQ(lit.values.size(), 160u * 90 * 4);
    ASSERT_EQ(alone.values.size(), lit.values.size());
    const std::array<int, 3> black{0, 0, 0};

    // The sky and the host's own triangle are not lumo's matter.
    EXPECT_EQ(pixel(lit, 0.5, 0.05), pixel(alone, 0.5, 0.05));
    EXPECT_EQ(pixel(lit, 0.08, 0.9), pixel(alone, 0.08, 0.9));
    EXPECT_NE(pixel(lit, 0.08, 0.9), pixel(lit, 0.02, 0.9));

    // The blue wall, which faces away from the sun; its shadow on the floor; and the sphere's.
    for (const auto& [x, y] : {std::pair(0.1, 0.5), {0.2, 0.8}, {0.72, 0.67}}) {
        EXPECT_EQ(pixel(alone, x, y), black) << x << ", " << y;
        EXPECT_NE(pixel(lit, x, y), black) << x << ", " << y;
    }
    // Light takes on the colour of what it comes from: the sphere's shadow that of the orange wall beside it.
    const auto shadow = pixel(lit, 0.72, 0.67);
    EXPECT_GT(shadow[0], shadow[2] + 20);
}

}  // namespace
}  // namespace lumo
