// A sample that saves its picture, as its users run it.
#pragma once

#include <array>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "scene/image.hpp"

namespace lumo::testing_support {

/// What `program` writes by `--headless`, 160x90, and these options; empty, and a failure, where it ends with an error.
inline scene::Image8 picture_of_sample(const std::string& program, const std::string& options) {
    const auto file = std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + ".sample.png");
    const std::string command =
        "'" + program + "' --headless --width 160 --height 90 -o '" + file.string() + "' " + options;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    auto image = scene::read_image8(file);
    std::filesystem::remove(file);
    if (!image) ADD_FAILURE() << to_string(image.error());
    return image.value_or(scene::Image8{});
}

/// Red, green and blue; x and y from the upper left corner, as parts of the picture's sides.
inline std::array<int, 3> pixel(const scene::Image8& image, double x, double y) {
    const uint8_t* at = image.at(uint32_t(x * image.width), uint32_t(y * image.height));
    return {at[0], at[1], at[2]};
}

}  // namespace lumo::testing_support
