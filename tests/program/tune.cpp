// lumo tune on a scene so small that its path-traced truth takes no time.
#include <gmock/gmock.h>
#include <sstream>

#include "program.hpp"

namespace lumo::test {
namespace {

using testing::HasSubstr;

class Tune : public Program {
  protected:
    /// Of cornell, with few settings free.
    static Arguments tuned(Arguments more) {
        Arguments all{"tune",     "cornell", "--size",      "32x18",   "--spp",       "32",
                      "--runs",   "1",       "--bounces",   "1",       "--storage",   "vt",
                      "--range",  "auto",    "--voxelizer", "compute", "--materials", "diffuse",
                      "--voxels", "16",      "--apertures", "uniform", "--quiet"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

/// What it prints renders, and keeps the bound against a reference that it did not choose by.
TEST_F(Tune, WhatItFindsKeepsTheBound) {
    const nlohmann::json found = nlohmann::json::parse(done(tuned({"--max-error", "80%", "--json"})).out);
    EXPECT_EQ(found["met"], true);
    EXPECT_EQ(found["max_error"], 0.8);
    EXPECT_LE(found["measured"]["relative_rmse"], 0.8);
    EXPECT_EQ(found["configurations"], 72);
    EXPECT_LE(found["trials"], 14);
    EXPECT_EQ(found["settings"].size(), 4);

    const auto command = found["command"].get<std::string>();
    for (const auto& [name, value] : found["settings"].items())
        EXPECT_THAT(command, HasSubstr(" --" + name + " " + value.get<std::string>()));
    Arguments render{"render", "cornell"};
    std::istringstream words(command.substr(command.find("cornell") + 7));
    for (std::string word; words >> word;) render.push_back(word);
    for (const char* more : {"--layer", "irradiance", "--quiet", "-o", "found.exr"})
        render.emplace_back(more);
    done(render);
    done({"render", "cornell", "--reference", "--spp", "64", "--size", "32x18", "--materials", "diffuse",
          "--layer", "irradiance", "--quiet", "-o", "truth.exr"});
    const nlohmann::json compared =
        nlohmann::json::parse(lumo({"diff", "truth.exr", "found.exr", "--json"}).out);
    // Against a third reference, all pixels counted.
    EXPECT_LE(compared["layers"][0]["relative_rmse"], 0.9);
}

/// Most light of the shadows is the sky's: a truth without it is off by far more.
TEST_F(Tune, TheTruthHasTheScenesSky) {
    const nlohmann::json found = nlohmann::json::parse(
        done({"tune",           "sky",     "--size",      "32x18", "--spp",       "64",
              "--runs",         "1",       "--bounces",   "1",     "--mips",      "ani",
              "--range",        "auto",    "--storage",   "vt",    "--voxelizer", "compute",
              "--materials",    "diffuse", "--voxels",    "32",    "--preset",    "fast",
              "--cones",        "9",       "--gather",    "cones", "--apertures", "uniform",
              "--rotate-cones", "on",      "--max-error", "20%",   "--json",      "--quiet"})
            .out);
    EXPECT_EQ(found["configurations"], 1);
    EXPECT_LT(found["measured"]["relative_rmse"], 0.2);
}

TEST_F(Tune, SaysWhereNoConfigurationKeepsTheBound) {
    const Outcome outcome = lumo(tuned({"--max-error", "0.001", "--cones", "9"}));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.out, HasSubstr("none was found that keeps the bounds"));
    EXPECT_THAT(outcome.out, HasSubstr("lumo render cornell --api "));
    const Outcome slow = lumo(tuned({"--max-ms", "0.000001", "--cones", "9"}));
    EXPECT_EQ(slow.exit_code, 1);
    EXPECT_THAT(slow.out, HasSubstr("none was found that keeps the bounds"));
}

TEST_F(Tune, RefusesWhatHasNoMeaning) {
    EXPECT_THAT(lumo({"tune", "cornell"}).err, HasSubstr("give --max-error or --max-ms"));
    EXPECT_THAT(lumo({"tune", "cornell", "--max-error", "0.2", "--api", "both"}).err,
                HasSubstr("for one device"));
    EXPECT_THAT(lumo({"tune", "cornell", "--max-error", "-1"}).err, HasSubstr("a number above 0"));
    EXPECT_THAT(lumo({"tune", "cornell", "--max-ms", "0"}).err, HasSubstr("a number above 0"));
    EXPECT_EQ(lumo({"tune", "cornell", "--max-error", "0.2", "--layer", "depth"}).exit_code, 2);
}

}  // namespace
}  // namespace lumo::test
