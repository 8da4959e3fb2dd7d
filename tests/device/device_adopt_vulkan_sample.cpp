// The sample embed-vulkan as its users run it: the host is as it was, and lit.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "backends/backends.hpp"
#include "scene/image.hpp"

namespace lumo {
namespace {

struct EmbedVulkan : testing::Test {
    void SetUp() override {
        if (backends::list_devices(rhi::Api::vulkan).empty()) GTEST_SKIP() << "there is no Vulkan device";
    }
    /// The picture that it writes; every message of the validation layers makes it fail.
    scene::Image8 run(const std::string& options) {
        const auto file =
            std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + ".embed-vulkan.png");
        const std::string command = std::string(LUMO_EMBED_VULKAN) +
                                    " --headless --validation --width 160 --height 90 -o '" + file.string() +
                                    "' " + options;
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        auto image = scene::read_image8(file);
        std::filesystem::remove(file);
        if (!image) ADD_FAILURE() << to_string(image.error());
        return image.value_or(scene::Image8{});
    }
};

std::array<int, 3> pixel(const scene::Image8& image, double x, double y) {
    const uint8_t* at = image.at(uint32_t(x * image.width), uint32_t(y * image.height));
    return {at[0], at[1], at[2]};
}

TEST_F(EmbedVulkan, IsLitByLumoAndLeftAsItWas) {
    const scene::Image8 lit = run("--check --frames 3"), alone = run("--no-gi");
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
    // Light takes on the colour of what it comes from: on the left the red wall, on the right the green one.
    EXPECT_EQ(pixel(alone, 0.24, 0.575), black) << "the tall box's shadow";
    const auto left = pixel(lit, 0.24, 0.575), right = pixel(lit, 0.85, 0.85);
    EXPECT_GT(left[0], left[1] + 10);
    EXPECT_GT(left[0], left[2] + 10);
    EXPECT_GT(right[1], right[0] + 10);
}

}  // namespace
}  // namespace lumo
