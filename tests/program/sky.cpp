// Scenes under a sky, as the command line asks for them.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>

#include "program.hpp"

namespace lumo::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class Sky : public Program {
  protected:
    static Arguments small(Arguments arguments) {
        for (const char* word : {"--size", "32x18", "--voxels", "32", "--preset", "fast", "--quiet"})
            arguments.emplace_back(word);
        return arguments;
    }
    scene::ImageF radiance(Arguments arguments) const {
        arguments.insert(arguments.end(), {"-o", "picture.exr"});
        done(small(std::move(arguments)));
        return exr("picture.exr").at(0).image;
    }
};

constexpr Part sky_part{0, 0, 1, 0.25}, ground_part{0, 0.9, 1, 1};

TEST_F(Sky, DaysAreBrighterThanDusks) {
    double before = 1e9;
    for (const char* sun : {"--sun=0.2,1,-0.2:1,1,1", "--sun=1,0.1,-0.2:1,1,1", "--sun=1,-0.08,-0.2:1,1,1"}) {
        const scene::ImageF image = radiance({"render", "sky", sun});
        const double sky = mean(image, sky_part, 1), ground = mean(image, ground_part, 1);
        EXPECT_GT(sky, 0);
        EXPECT_GT(ground, 0);
        EXPECT_LT(ground, 0.5 * before) << sun;
        before = ground;
    }
    // The day is blue.
    const scene::ImageF day = radiance({"render", "sky"});
    EXPECT_GT(mean(day, sky_part, 2), 1.5 * mean(day, sky_part, 0));
}

TEST_F(Sky, TakesThePlaceOfWhatLitTheScene) {
    const scene::ImageF bright = radiance({"render", "atrium", "--sky", "on"});
    const scene::ImageF same = radiance({"render", "atrium", "--sky", "on", "--sun=-0.36,1,0.38:9,0,0"});
    for (const int c : {0, 1, 2})
        EXPECT_NEAR(mean(same, {}, uint32_t(c)), mean(bright, {}, uint32_t(c)), 1e-3 * mean(bright, {}, 1))
            << "the irradiance of --sun does not count";
    // Shown at the exposure of daylight, it is about as bright as the scene by its own light.
    done(small({"render", "atrium", "--sky", "on", "-o", "sky.png"}));
    done(small({"render", "atrium", "-o", "own.png"}));
    EXPECT_NEAR(mean(png("sky.png"), {}, 1), mean(png("own.png"), {}, 1), 40);
}

TEST_F(Sky, AnAtmosphereIsReadFromAFile) {
    write("none.json", R"({"wavelengths_nm": [680, 550, 440], "radius_ground_km": 6360, "radius_top_km": 6420,
        "sun": {"irradiance": [1.474, 1.8504, 1.91198], "angular_radius_deg": 0.2678},
        "ground_albedo": [0, 0, 0]})");
    const scene::ImageF space = radiance({"render", "sky", "--atmosphere", "none.json"});
    EXPECT_EQ(mean(space, {0, 0, 0.2, 0.2}, 1), 0) << "without air the sky is black";
    EXPECT_GT(mean(space, ground_part, 1), 1) << "and the ground is in the sun";
    write("wrong.json", R"({"wavelengths_nm": []})");
    const Outcome wrong = lumo({"render", "sky", "--atmosphere", "wrong.json"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.err, HasSubstr("wrong.json"));
}

TEST_F(Sky, IsThinnerHigherUp) {
    const auto zenith = [&](const char* altitude) {
        return mean(radiance({"render", "sky", "--altitude", altitude, "--camera", "0,5,0:0,6,0.01:20"}), {},
                    2);
    };
    const double low = zenith("0"), high = zenith("20");
    EXPECT_LT(high, 0.3 * low);
    EXPECT_LT(zenith("100"), 1e-3 * low);
}

TEST_F(Sky, IsLeftOutWhereItIsNotNeeded) {
    const auto left_out = [&](Arguments arguments) {
        arguments.insert(arguments.end(), {"--stats", "run.json", "-o", "picture.exr"});
        done(small(std::move(arguments)));
        std::vector<std::string> names;
        const nlohmann::json run = json("run.json");
        for (const auto& item : run["left_out"]) names.push_back(item["what"]);
        return names;
    };
    EXPECT_THAT(left_out({"render", "cornell"}), testing::IsSupersetOf({"sky.map", "sky.pixels"}));
    EXPECT_THAT(left_out({"render", "sky"}), Not(Contains(HasSubstr("sky."))));
    EXPECT_THAT(left_out({"render", "sky", "--gi", "off"}), Contains("sky.map"));
    EXPECT_THAT(left_out({"render", "sky", "--layer", "irradiance"}), Contains("sky.pixels"));
    EXPECT_EQ(json("run.json")["settings"]["layer"], "irradiance");
    // Below the horizon the sun is no light.
    EXPECT_THAT(left_out({"render", "sky", "--sun=1,-0.2,0:1,1,1"}), Contains("shadow"));
}

TEST_F(Sky, SettingsAreRepeatedFromAFile) {
    done(small(
        {"render", "atrium", "--sky", "on", "--altitude", "2.5", "--stats", "run.json", "-o", "first.png"}));
    EXPECT_EQ(json("run.json")["settings"]["sky"], "on");
    done({"render", "--config", "run.json", "--quiet", "-o", "second.png"});
    EXPECT_EQ(png("first.png").values, png("second.png").values);
}

/// The same sky from the path tracer: as seen, and as irradiance on the ground.
TEST_F(Sky, PathTracerHasTheSameSky) {
    const Arguments scene{"render",      "sky",
                          "--materials", "diffuse",
                          "--camera",    "0,3,40:0,3.2,80:50",
                          "--layer",     "radiance,irradiance"};
    Arguments arguments = scene;
    arguments.insert(arguments.end(), {"-o", "frame.exr"});
    done(small(arguments));
    arguments = scene;
    arguments.insert(arguments.end(), {"--reference", "--spp", "64", "-o", "truth.exr"});
    done(small(arguments));
    const auto layer = [&](const char* file, std::string_view name) {
        for (const scene::ExrLayer& found : exr(file))
            if (found.name == name) return found.image;
        ADD_FAILURE() << file << " has no " << name;
        return scene::ImageF{};
    };
    const scene::ImageF drawn = layer("frame.exr", "radiance"), traced = layer("truth.exr", "radiance");
    const scene::ImageF lit = layer("frame.exr", "irradiance"), truly_lit = layer("truth.exr", "irradiance");
    for (const uint32_t c : {0u, 1u, 2u}) {
        const double sky = mean(traced, {0, 0, 1, 0.4}, c), ground = mean(truly_lit, {0, 0.8, 1, 1}, c);
        EXPECT_GT(sky, 0);
        EXPECT_NEAR(mean(drawn, {0, 0, 1, 0.4}, c), sky, 0.02 * sky) << c;
        EXPECT_NEAR(mean(lit, {0, 0.8, 1, 1}, c), ground, 0.15 * ground) << c;
    }
}

}  // namespace
}  // namespace lumo::test
