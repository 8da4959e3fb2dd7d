// Pictures that the program makes.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <map>
#include <set>

#include "program.hpp"

namespace lumo::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A frame small enough for software drivers.
Arguments small(Arguments arguments) {
    for (const char* word : {"--size", "64x36", "--voxels", "32", "--quiet"}) arguments.emplace_back(word);
    return arguments;
}

std::vector<std::string> names_of(const nlohmann::json& list, const char* key) {
    std::vector<std::string> names;
    for (const auto& item : list) names.push_back(item[key]);
    return names;
}

class Render : public Program {
  protected:
    /// cards.gltf: on the ground a red card beyond a green one, both shining, and two cameras.
    void write_cards() const {
        write("cards.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
            "nodes": [{"mesh": 0, "translation": [0, 0, -2]}, {"mesh": 1},
                      {"camera": 0, "name": "near", "translation": [0, 2, 6]},
                      {"camera": 0, "name": "far", "translation": [0, 2, 9]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
                       {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}],
            "materials": [{"emissiveFactor": [1, 0, 0]}, {"emissiveFactor": [0, 1, 0]}],)" +
                                std::string(triangle_accessor) + "}");
    }
};
class RenderOnApi : public ProgramOnApi {
  protected:
    Arguments on_api(Arguments arguments) const {
        arguments.insert(arguments.end(), {"--api", GetParam()});
        return small(std::move(arguments));
    }
};
INSTANTIATE_TEST_SUITE_P(Apis, RenderOnApi, testing::Values("gl", "vulkan"),
                         [](const auto& api) { return api.param; });

TEST_P(RenderOnApi, CornellStandsUprightWithItsRedWallOnTheLeft) {
    done(on_api({"render", "cornell", "-o", "c.png"}));
    done(on_api({"render", "cornell", "-o", "c.exr"}));
    const scene::Image8 display = png("c.png");
    const auto layers = exr("c.exr");
    ASSERT_EQ(layers.size(), 1);
    EXPECT_EQ(layers[0].name, "");
    ASSERT_EQ(layers[0].image.channels, 3);
    const auto check = [](const auto& image) {
        ASSERT_EQ(image.width, 64);
        ASSERT_EQ(image.height, 36);
        // The box fills the middle of the wide picture: walls left and right of it, lamp at its top.
        const Part left{0.25, 0.3, 0.31, 0.7}, right{0.69, 0.3, 0.75, 0.7};
        const Part lamp{0.46, 0.1, 0.54, 0.16}, floor{0.46, 0.84, 0.54, 0.9};
        EXPECT_GT(mean(image, left, 0), 1.2 * mean(image, left, 1));
        EXPECT_GT(mean(image, right, 1), 1.2 * mean(image, right, 0));
        EXPECT_GT(mean(image, lamp, 0), 1.5 * mean(image, floor, 0));
    };
    check(display);
    check(layers[0].image);
}

TEST_P(RenderOnApi, EveryBuiltInSceneIsLit) {
    for (const char* name : {"atrium", "cornell", "area-light", "furnace"}) {
        done(on_api({"render", name, "-o", "picture.exr"}));
        const auto layers = exr("picture.exr");
        ASSERT_EQ(layers.size(), 1);
        double brightest = 0;
        for (const float value : layers[0].image.values) {
            ASSERT_TRUE(std::isfinite(value)) << name;
            ASSERT_GE(value, 0) << name;
            brightest = std::max(brightest, double(value));
        }
        EXPECT_GT(brightest, 0.1) << name;
    }
}

TEST_P(RenderOnApi, FullPlanGivesTheSameBits) {
    for (const char* name : {"atrium", "cornell"}) {
        done(on_api({"render", name, "-o", "auto.png", "--stats", "auto.json"}));
        done(on_api({"render", name, "-o", "full.png", "--stats", "full.json", "--plan", "full"}));
        EXPECT_EQ(png("auto.png").values, png("full.png").values) << name;
        EXPECT_FALSE(json("auto.json")["left_out"].empty()) << name;
        EXPECT_TRUE(json("full.json")["left_out"].empty()) << name;
    }
}

TEST_P(RenderOnApi, LayersAddUpToRadiance) {
    done(on_api({"render", "cornell", "--sun", "0.1,0.5,1:3,2,1", "-o", "layers.exr", "--layer",
                 "final,radiance,direct,indirect,specular,emission,irradiance,albedo,normal,depth,voxels"}));
    std::map<std::string, scene::ImageF> layers;
    auto read = exr("layers.exr");
    for (scene::ExrLayer& layer : read) layers[layer.name] = std::move(layer.image);
    ASSERT_EQ(layers.size(), 11);
    EXPECT_EQ(layers[""].values, layers["radiance"].values);
    EXPECT_EQ(layers["depth"].channels, 1);
    double direct = 0, indirect = 0, specular = 0, emission = 0;
    for (size_t i = 0; i < layers["radiance"].values.size(); ++i) {
        const float sum = layers["direct"].values[i] + layers["indirect"].values[i] +
                          layers["specular"].values[i] + layers["emission"].values[i];
        EXPECT_NEAR(layers["radiance"].values[i], sum, 1e-5 * std::max(sum, 1.0f)) << i;
        direct += layers["direct"].values[i];
        indirect += layers["indirect"].values[i];
        specular += layers["specular"].values[i];
        emission += layers["emission"].values[i];
    }
    EXPECT_GT(direct, 0);
    EXPECT_GT(indirect, 0);
    EXPECT_GT(specular, 0);
    EXPECT_GT(emission, 0);

    const auto& depth = layers["depth"].values;
    for (size_t pixel = 0; pixel < depth.size(); ++pixel) {
        const float* normal = &layers["normal"].values[3 * pixel];
        const float length = std::hypot(normal[0], normal[1], normal[2]);
        EXPECT_NEAR(length, depth[pixel] > 0 ? 1 : 0, 2e-3) << pixel;
    }
}

TEST_P(RenderOnApi, StatsHoldTheContractsFields) {
    done(on_api({"render", "cornell", "-o", "c.png", "--stats", "c.json"}));
    const nlohmann::json stats = json("c.json");
    EXPECT_EQ(stats["api"], GetParam());
    EXPECT_FALSE(stats["device"].get<std::string>().empty());
    EXPECT_FALSE(stats["driver"].get<std::string>().empty());
    EXPECT_EQ(stats["settings"]["scene"], "cornell");
    EXPECT_EQ(stats["settings"]["voxels"], 32);
    EXPECT_EQ(stats["settings"]["size"], "64x36");
    double passes = 0;
    for (const auto& pass : stats["passes"]) {
        EXPECT_FALSE(pass["name"].get<std::string>().empty());
        EXPECT_GE(pass["gpu_ms"].get<double>(), 0);
        passes += pass["gpu_ms"].get<double>();
    }
    EXPECT_GT(passes, 0);
    if (stats["timing_mode"] == "serialised") {
        EXPECT_LE(passes, stats["wall_ms"].get<double>());
    }
    uint64_t bytes = 0;
    for (const auto& entry : stats["memory"]) bytes += entry["bytes"].get<uint64_t>();
    EXPECT_GT(bytes, 32u * 32 * 32 * 4);
    for (const auto& item : stats["left_out"]) EXPECT_FALSE(item["why"].get<std::string>().empty());
    EXPECT_EQ(stats["dropped_voxel_writes"], 0);
    EXPECT_THAT((std::set<std::string>{"serialised", "overlapped"}), Contains(stats["timing_mode"]));
}

TEST_P(RenderOnApi, WhatASceneLacksIsNeitherRunNorHeld) {
    done(on_api({"render", "atrium", "-o", "a.png", "--stats", "a.json"}));
    const nlohmann::json stats = json("a.json");
    const auto passes = names_of(stats["passes"], "name");
    const auto memory = names_of(stats["memory"], "name");
    const auto left_out = names_of(stats["left_out"], "what");
    EXPECT_THAT(passes, Contains(HasSubstr("voxel")));
    EXPECT_THAT(memory, Contains(HasSubstr("voxel")));
    EXPECT_THAT(passes, Not(Contains(HasSubstr("emission"))));
    EXPECT_THAT(memory, Not(Contains(HasSubstr("emission"))));
    EXPECT_THAT(left_out, Contains("voxels.emission"));
    EXPECT_THAT(left_out, Contains("gbuffer.mask"));
    EXPECT_THAT(left_out, Contains("voxels.mask"));

    done(on_api({"render", "cornell", "-o", "c.png", "--stats", "c.json"}));
    EXPECT_THAT(names_of(json("c.json")["passes"], "name"), Contains(HasSubstr("emission")));
    EXPECT_THAT(names_of(json("c.json")["passes"], "name"), Not(Contains(HasSubstr("shadow"))));

    done(on_api({"render", "cornell", "--gi", "off", "-o", "off.png", "--stats", "off.json"}));
    EXPECT_THAT(names_of(json("off.json")["passes"], "name"), Not(Contains(HasSubstr("voxel"))));
    EXPECT_THAT(names_of(json("off.json")["memory"], "name"), Not(Contains(HasSubstr("voxel"))));
}

TEST_F(Render, BothApisAgree) {
    for (const char* name : {"cornell", "area-light", "furnace"}) {
        const Outcome run =
            done(small({"render", name, "--api", "both", "-o", "b.exr", "--stats", "b.json"}));
        EXPECT_EQ(run.out, "") << "quiet, and nothing to complain of";
        const auto gl = exr("b.gl.exr"), vulkan = exr("b.vulkan.exr"), difference = exr("b.diff.exr");
        ASSERT_EQ(difference.size(), 1);
        for (size_t i = 0; i < difference[0].image.values.size(); ++i) {
            ASSERT_EQ(difference[0].image.values[i],
                      std::abs(gl[0].image.values[i] - vulkan[0].image.values[i]));
        }
        EXPECT_EQ(json("b.gl.json")["api"], "gl");
        EXPECT_EQ(json("b.vulkan.json")["api"], "vulkan");
    }
    const Outcome run =
        lumo({"render", "cornell", "--api", "both", "--size", "64x36", "--voxels", "32", "-o", "b.png"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_TRUE(contains(run.out, "parity")) << run.out;
    EXPECT_EQ(png("b.diff.png").width, 64);
}

TEST_F(Render, FirstApiThatWorksIsNamed) {
    const Outcome run = done({"render", "cornell", "--size", "16x9", "--voxels", "16"});
    EXPECT_TRUE(contains(run.err, "vulkan on ")) << run.err;
    EXPECT_TRUE(std::filesystem::exists(path("cornell.png")));
    EXPECT_FALSE(contains(run.err, "\033")) << "no progress bar in a pipe";

    const Outcome other = lumo({"render", "cornell", "--size", "16x9", "--voxels", "16"},
                               {{"VK_ICD_FILENAMES", "/nowhere.json"}, {"VK_DRIVER_FILES", "/nowhere.json"}});
    EXPECT_EQ(other.exit_code, 0) << other.err;
    EXPECT_TRUE(contains(other.err, "gl on ")) << other.err;
}

TEST_F(Render, QuietSaysNothing) {
    const Outcome run = done(small({"render", "cornell", "-o", "c.png"}));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err, "");
}

TEST_F(Render, ExplainPrintsThePlan) {
    const Outcome run = done(small({"render", "cornell", "-o", "c.png", "--explain"}));
    EXPECT_TRUE(contains(run.out, "needed   voxels ")) << run.out;
    EXPECT_TRUE(contains(run.out, "left out shadow ")) << run.out;
}

TEST_F(Render, ConfigRepeatsARun) {
    done(small({"render",         "cornell",
                "--exposure",     "2.5",
                "--tonemap",      "agx",
                "--camera",       "0.3,2.7,13:0.1,2.5,0:38",
                "--sun",          "0.1,0.5,1:3,2,1",
                "--cones",        "5",
                "--apertures",    "nonuniform",
                "--rotate-cones", "on",
                "--storage",      "svo",
                "--mips",         "iso",
                "--range",        "fixed",
                "--voxelizer",    "raster",
                "--materials",    "diffuse",
                "--photometric",  "-o",
                "a.png",          "--stats",
                "a.json"}));
    done({"render", "--config", "a.json", "--quiet", "-o", "b.png", "--stats", "b.json"});
    EXPECT_EQ(json("a.json")["settings"], json("b.json")["settings"]);
    EXPECT_EQ(bytes("a.png"), bytes("b.png"));

    done({"render", "--config", "a.json", "--exposure", "0", "--quiet", "-o", "c.png", "--stats", "c.json"});
    EXPECT_EQ(json("c.json")["settings"]["exposure"], 0) << "the command line comes first";
    EXPECT_EQ(json("c.json")["settings"]["tonemap"], "agx");
}

TEST_F(Render, CamerasByNameIndexAndNumbers) {
    write_cards();
    done(small({"render", "cards.gltf", "-o", "own.png"}));
    done(small({"render", "cards.gltf", "--camera", "0", "-o", "index.png"}));
    done(small({"render", "cards.gltf", "--camera", "near", "-o", "name.png"}));
    done(small({"render", "cards.gltf", "--camera", "1", "-o", "other.png"}));
    EXPECT_EQ(bytes("own.png"), bytes("index.png"));
    EXPECT_EQ(bytes("own.png"), bytes("name.png"));
    EXPECT_NE(bytes("own.png"), bytes("other.png"));
}

TEST_F(Render, LookingStraightDownHasMinusZUp) {
    write_cards();
    done(small({"render", "cards.gltf", "--camera", "0,6,0:0,0,0:40", "-o", "down.exr"}));
    const auto layers = exr("down.exr");
    const Part top{0.4, 0.1, 0.6, 0.45}, bottom{0.4, 0.55, 0.6, 0.9};
    EXPECT_GT(mean(layers[0].image, top, 0), 0.05);
    EXPECT_GT(mean(layers[0].image, bottom, 1), 0.05);
    EXPECT_GT(mean(layers[0].image, top, 0), 4 * mean(layers[0].image, top, 1));
    EXPECT_GT(mean(layers[0].image, bottom, 1), 4 * mean(layers[0].image, bottom, 0));
}

TEST_F(Render, TheSunCanBeSetAndTakenAway) {
    const auto direct = [&](const std::string& sun, uint32_t channel) {
        done(small({"render", "cornell", "--sun", sun, "--gi", "off", "--layer", "direct", "-o", "sun.exr"}));
        const auto layers = exr("sun.exr");
        return mean(layers[0].image, {}, channel);
    };
    EXPECT_EQ(direct("none", 0), 0);
    EXPECT_GT(direct("0.1,0.5,1:4,0,0", 0), 0);
    EXPECT_EQ(direct("0.1,0.5,1:4,0,0", 1), 0);
    EXPECT_NE(direct("0.1,0.5,1:4,0,0", 0), direct("0.1,0.2,1:4,0,0", 0));
}

TEST_F(Render, ExposureDoublesTheLight) {
    done(small({"render", "furnace", "--exposure", "-1", "-o", "half.png"}));
    // The furnace has radiance 1 everywhere: half of it is 188 as sRGB.
    EXPECT_NEAR(mean(png("half.png"), {}, 1), 188, 2);
}

TEST_F(Render, AnimationsComeInNumberedFilesAndShards) {
    const Arguments animation{"render", "cornell", "--frames", "3", "--orbit", "30", "-o", "turn.png"};
    done(small(animation));
    for (const char* name : {"turn.0001.png", "turn.0002.png", "turn.0003.png"})
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    EXPECT_NE(bytes("turn.0001.png"), bytes("turn.0003.png"));
    done(small({"render", "cornell", "-o", "still.png"}));
    EXPECT_EQ(bytes("turn.0001.png"), bytes("still.png"));

    const std::string second = bytes("turn.0002.png");
    for (const char* name : {"turn.0001.png", "turn.0002.png", "turn.0003.png"})
        std::filesystem::remove(path(name));
    Arguments shard = animation;
    shard.insert(shard.end(), {"--shard", "2/2"});
    done(small(shard));
    EXPECT_EQ(bytes("turn.0002.png"), second);
    EXPECT_FALSE(std::filesystem::exists(path("turn.0001.png")));
    EXPECT_FALSE(std::filesystem::exists(path("turn.0003.png")));
}

TEST_F(Render, SharedFilesAgreeOnBothApis) {
    const std::filesystem::path folder = shared_data("gltf");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
    int files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension();
        if (extension != ".gltf" && extension != ".glb") continue;
        ++files;
        done(small({"render", entry.path(), "--api", "both", "-o", "f.exr"}));
        double sum = 0;
        const auto layers = exr("f.gl.exr");
        for (const float value : layers[0].image.values) sum += value;
        EXPECT_GT(sum, 0) << entry.path();
    }
    EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace lumo::test
