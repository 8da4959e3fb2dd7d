// What the program says of scenes, and of files that are not as they should be.
#include <algorithm>
#include <gmock/gmock.h>

#include "program.hpp"

namespace lumo::test {
namespace {

using testing::Contains;

class Check : public Program {};

std::vector<std::string> whats(const nlohmann::json& list) {
    std::vector<std::string> names;
    for (const auto& item : list) names.push_back(item["what"]);
    return names;
}

TEST_F(Check, SponzaHoldsWhatItsReadmeSays) {
    const std::filesystem::path sponza = shared_data("sponza/Sponza.gltf");
    if (!std::filesystem::exists(sponza)) GTEST_SKIP() << sponza << " is not here";
    const auto report = nlohmann::json::parse(done({"check", sponza, "--json"}).out);
    EXPECT_EQ(report["counts"]["triangles"], 262267);
    EXPECT_EQ(report["counts"]["vertices"], 192647);
    EXPECT_EQ(report["counts"]["materials"], 25);
    EXPECT_EQ(report["counts"]["images"], 69);
    EXPECT_NEAR(report["bounds"]["min"][0].get<double>(), -15.37, 0.01);
    EXPECT_NEAR(report["bounds"]["max"][1].get<double>(), 11.44, 0.01);
    std::vector<std::string> masked;
    for (const auto& material : report["materials"]) {
        if (material["alpha_mode"] == "MASK") masked.push_back(material["name"]);
    }
    EXPECT_THAT(masked, testing::UnorderedElementsAre("thorn", "plant", "chain"));
    EXPECT_THAT(whats(report["plan"]["needed"]), Contains("gbuffer.mask"));
    EXPECT_THAT(whats(report["plan"]["left_out"]), Contains("voxels.emission"));

    const std::string text = done({"check", sponza}).out;
    for (const char* part :
         {"262267", "fabric_green", "MASK at 0.5, double-sided", "left out voxels.emission"})
        EXPECT_TRUE(contains(text, part)) << part;
}

TEST_F(Check, ThePlanFollowsTheSettings) {
    const auto plan = [&](const Arguments& arguments) {
        return nlohmann::json::parse(done(arguments).out)["plan"];
    };
    EXPECT_THAT(whats(plan({"check", "cornell", "--json"})["needed"]), Contains("voxels.emission"));
    EXPECT_THAT(whats(plan({"check", "cornell", "--gi", "off", "--json"})["left_out"]), Contains("voxels"));
    EXPECT_TRUE(plan({"check", "cornell", "--plan", "full", "--json"})["left_out"].empty());
    EXPECT_THAT(whats(plan({"check", "atrium", "--json"})["needed"]), Contains("gbuffer.normal_maps"));
    EXPECT_THAT(whats(plan({"check", "atrium", "--materials", "diffuse", "--json"})["left_out"]),
                Contains("gbuffer.normal_maps"));
}

TEST_F(Check, NamesFromFilesDoNotReachTheTerminalRaw) {
    write("names.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"camera": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}, {"mesh": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}, "name": "cam\u001b[2J"}],
        "materials": [{"name": "red\u001b[31m\nfake line"}],
        "meshes": [{"name": "\u0007", "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "extensionsUsed": ["KHR_lights_punctual", "EXT_\u001b[31m"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "name": "lamp\u001b[5m"}]}},)" +
                            std::string(triangle_accessor) + "}");
    const Outcome run = done({"check", "names.gltf"});
    EXPECT_FALSE(contains(run.out, "\033")) << run.out;
    EXPECT_FALSE(contains(run.out, "\007"));
    EXPECT_FALSE(contains(run.out, "\nfake line"));
    EXPECT_TRUE(contains(run.out, "cam?[2J")) << run.out;
    EXPECT_TRUE(contains(run.out, "red?[31m?fake line")) << run.out;
    EXPECT_TRUE(contains(run.out, "lamp?[5m: point")) << run.out;
}

TEST_F(Check, MalformedFilesEndWithOneLineThatNamesThem) {
    const std::filesystem::path folder = shared_data("gltf-invalid");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
    // The loader's own tests read every one of them.
    constexpr int every = 10;
    int seen = 0, loaded = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension();
        if (!entry.is_regular_file() || (extension != ".gltf" && extension != ".glb")) continue;
        if (seen++ % every != 0) continue;
        const Outcome run = lumo({"check", entry.path()});
        ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 2) << entry.path() << ": " << run.exit_code;
        EXPECT_FALSE(contains(run.out + run.err, "\033")) << entry.path();
        if (run.exit_code == 0) {
            ++loaded;
            EXPECT_EQ(run.err, "") << entry.path();
        } else {
            ++refused;
            EXPECT_EQ(run.out, "") << entry.path();
            EXPECT_EQ(lines(run.err), 1) << run.err;
            EXPECT_TRUE(contains(run.err, entry.path().filename())) << entry.path() << ": " << run.err;
        }
    }
    EXPECT_GT(loaded, 0);
    EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace lumo::test
