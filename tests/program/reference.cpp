// The path tracer from the command line.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>

#include "program.hpp"

namespace lumo::test {
namespace {

using testing::HasSubstr;

class Reference : public Program {
  protected:
    /// 32 x 18 pixels of a scene, at any number of samples.
    static Arguments traced(const char* scene, Arguments more) {
        Arguments all{"render", scene, "--reference", "--size", "32x18", "--quiet"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

TEST_F(Reference, WritesTheRenderersLayers) {
    const Arguments layers{"--layer", "depth,albedo,direct,final", "--materials", "diffuse", "-o"};
    Arguments drawn{"render", "atrium", "--size", "32x18", "--voxels", "32", "--quiet"};
    drawn.insert(drawn.end(), layers.begin(), layers.end());
    drawn.emplace_back("drawn.exr");
    done(drawn);
    Arguments trace = traced("atrium", {"--spp", "2"});
    trace.insert(trace.end(), layers.begin(), layers.end());
    trace.emplace_back("traced.exr");
    done(trace);

    const auto a = exr("drawn.exr"), b = exr("traced.exr");
    ASSERT_EQ(a.size(), 4);
    ASSERT_EQ(b.size(), 4);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(a[i].name, b[i].name);
        ASSERT_EQ(a[i].image.values.size(), b[i].image.values.size());
    }
    // What is seen is the same, but where a pixel's centre is on an edge.
    const auto depth = [](const auto& layers) {
        return std::ranges::find(layers, std::string("depth"), &scene::ExrLayer::name)->image.values;
    };
    size_t off = 0;
    const auto here = depth(a), there = depth(b);
    for (size_t i = 0; i < here.size(); ++i) off += std::abs(here[i] - there[i]) > 1e-3f * there[i];
    EXPECT_LE(off, here.size() / 100);
}

TEST_F(Reference, TellsItsNoiseWhichMoreSamplesLower) {
    const auto noise = [&](const char* spp) {
        done(
            traced("cornell", {"--spp", spp, "--layer", "irradiance", "--stats", "run.json", "-o", "c.exr"}));
        const nlohmann::json run = json("run.json");
        EXPECT_EQ(run["api"], "reference");
        EXPECT_EQ(run["settings"]["reference"], true);
        EXPECT_GT(run["wall_ms"], 0);
        return run["relative_noise"]["irradiance"].get<double>();
    };
    const double few = noise("4"), many = noise("256");
    EXPECT_GT(many, 0);
    EXPECT_LT(many, few / 4);
}

TEST_F(Reference, IsRepeatedByItsStats) {
    done(traced("cornell", {"--spp", "2", "--bounces", "3", "--stats", "run.json", "-o", "first.exr"}));
    done({"render", "--config", "run.json", "--quiet", "-o", "second.exr"});
    EXPECT_EQ(exr("first.exr").at(0).image.values, exr("second.exr").at(0).image.values);
}

TEST_F(Reference, RefusesWhatItHasNot) {
    for (const Arguments& more :
         {Arguments{"-o", "a.png"}, {"--api", "gl"}, {"--layer", "voxels"}, {"--gi", "off"}}) {
        const Outcome outcome = lumo(traced("cornell", more));
        EXPECT_EQ(outcome.exit_code, 2) << more[0];
        EXPECT_THAT(outcome.err, HasSubstr(more[0] == "-o" || more[0] == "--api" ? "--reference" : more[0]));
    }
    EXPECT_THAT(lumo(traced("cornell", {"--spp", "1"})).err, HasSubstr("--spp"));
}

}  // namespace
}  // namespace lumo::test
