// The sample embed-gl as its users run it: the host's state is as it was, the driver silent, the picture lit.
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

struct EmbedGl : testing::Test {
    void SetUp() override {
        if (backends::list_devices(rhi::Api::gl).empty()) GTEST_SKIP() << "there is no OpenGL device";
    }
    /// The picture that it writes.
    static scene::Image8 run(const std::string& options) {
        const auto file =
            std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + ".embed-gl.png");
        const std::string command = std::string(LUMO_EMBED_GL) + " --headless --width 160 --height 90 -o '" +
                                    file.string() + "' " + options;
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

TEST_F(EmbedGl, IsLitByLumoAndFindsItsState) {
    const scene::Image8 lit = run("--check-state --frames 3"), alone = run("--no-gi");
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
