// Comparing pictures.
#include <algorithm>

#include "program.hpp"

namespace lumo::test {
namespace {

class Diff : public Program {
  protected:
    static constexpr uint32_t side = 100;

    /// A smooth ramp, with the first `changed` pixels `step` brighter.
    void write_ramp(const std::string& name, uint32_t changed, uint8_t step) const {
        scene::Image8 image{side, side, 3, std::vector<uint8_t>(size_t(side) * side * 3)};
        for (uint32_t y = 0; y < side; ++y) {
            for (uint32_t x = 0; x < side; ++x)
                std::fill_n(image.at(x, y), 3, uint8_t(50 + x + (y * side + x < changed ? step : 0)));
        }
        ASSERT_TRUE(scene::write_png(path(name), image));
    }

    void write_ramp_exr(const std::string& name, float factor) const {
        scene::ImageF image{side, side, 3, std::vector<float>(size_t(side) * side * 3)};
        for (uint32_t y = 0; y < side; ++y) {
            for (uint32_t x = 0; x < side; ++x) std::fill_n(image.at(x, y), 3, float(1 + x) * factor);
        }
        const std::vector<scene::ExrLayer> layers{{.image = image}, {.name = "direct", .image = image}};
        ASSERT_TRUE(scene::write_exr(path(name), layers));
    }
};

TEST_F(Diff, EqualPicturesPass) {
    write_ramp("a.png", 0, 0);
    const Outcome run = done({"diff", "a.png", "a.png", "-o", "d.png"});
    EXPECT_TRUE(contains(run.out, "parity                      passed")) << run.out;
    const scene::Image8 difference = png("d.png");
    EXPECT_EQ(mean(difference, {}, 0) + mean(difference, {}, 1) + mean(difference, {}, 2), 0);
}

TEST_F(Diff, TheRuleDecidesTheExitCode) {
    write_ramp("a.png", 0, 0);
    write_ramp("one_step.png", side * side, 1);
    write_ramp("one_pixel.png", 1, 30);
    write_ramp("some_pixels.png", 5, 30);
    write_ramp("more_pixels.png", 20, 30);
    EXPECT_EQ(lumo({"diff", "a.png", "one_step.png"}).exit_code, 0) << "1/255 everywhere";
    EXPECT_EQ(lumo({"diff", "a.png", "one_pixel.png"}).exit_code, 0) << "99.99 % of 10 000 pixels";
    EXPECT_EQ(lumo({"diff", "a.png", "some_pixels.png"}).exit_code, 1);
    EXPECT_EQ(lumo({"diff", "a.png", "some_pixels.png", "--rule", "hardware"}).exit_code, 0);
    EXPECT_EQ(lumo({"diff", "a.png", "more_pixels.png", "--rule", "hardware"}).exit_code, 1);
}

TEST_F(Diff, LinearLayersAreComparedEach) {
    write_ramp_exr("a.exr", 1);
    write_ramp_exr("near.exr", 1 + 5e-4f);
    EXPECT_EQ(lumo({"diff", "a.exr", "near.exr"}).exit_code, 1);
    EXPECT_EQ(lumo({"diff", "a.exr", "near.exr", "--rule", "hardware"}).exit_code, 0);
    const Outcome run = lumo({"diff", "a.exr", "near.exr", "--json", "-o", "d.exr"});
    EXPECT_EQ(run.exit_code, 1);
    const auto report = nlohmann::json::parse(run.out);
    EXPECT_EQ(report["passed"], false);
    ASSERT_EQ(report["layers"].size(), 2);
    EXPECT_EQ(report["layers"][0]["layer"], "");
    EXPECT_EQ(report["layers"][1]["layer"], "direct");
    EXPECT_NEAR(report["layers"][1]["bias"].get<double>(), 5e-4, 1e-5);
    const auto difference = exr("d.exr");
    ASSERT_EQ(difference.size(), 2);
    EXPECT_NEAR(*difference[0].image.at(99, 0), 100 * 5e-4, 1e-4);
}

TEST_F(Diff, WhatCannotBeComparedFails) {
    write_ramp("a.png", 0, 0);
    write_ramp_exr("a.exr", 1);
    write("text.png", "not a picture");
    scene::Image8 other{10, 10, 3, std::vector<uint8_t>(300)};
    ASSERT_TRUE(scene::write_png(path("other.png"), other));
    for (const std::string b : {"a.exr", "text.png", "other.png", "missing.png", "a.txt"}) {
        const Outcome run = lumo({"diff", "a.png", b});
        EXPECT_EQ(run.exit_code, 2) << b;
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, b)) << run.err;
    }
}

}  // namespace
}  // namespace lumo::test
