// What the program says about itself, and what it refuses.
#include "program.hpp"

namespace lumo::test {
namespace {

class CommandLine : public Program {};

TEST_F(CommandLine, HelpOfEverySubcommandHasExamples) {
    for (const std::string name : {"render", "check", "diff", "devices", "bench", "probe", "report"}) {
        const Outcome run = done({name, "--help"});
        EXPECT_TRUE(contains(run.out, "Examples:\n  lumo " + name)) << run.out;
        EXPECT_EQ(run.err, "");
    }
}

TEST_F(CommandLine, HelpListsTheSubcommands) {
    const Outcome run = done({"--help"});
    for (const char* name : {"render", "check", "diff", "devices", "bench", "probe", "report"})
        EXPECT_TRUE(contains(run.out, name));
}

TEST_F(CommandLine, NothingToDoIsAFailure) {
    const Outcome run = lumo({});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(contains(run.err, "render"));
}

TEST_F(CommandLine, VersionNamesBuildAndDrivers) {
    const Outcome run = done({"--version"});
    EXPECT_TRUE(run.out.starts_with("lumo ")) << run.out;
    EXPECT_TRUE(contains(run.out, "\nvulkan ")) << run.out;
    EXPECT_TRUE(contains(run.out, "\ngl ")) << run.out;
}

TEST_F(CommandLine, DevicesAsTextAndJson) {
    const auto json = nlohmann::json::parse(done({"devices", "--json"}).out);
    const std::string text = done({"devices"}).out;
    for (const char* api : {"vulkan", "gl"}) {
        ASSERT_FALSE(json[api].empty()) << api;
        for (const auto& device : json[api]) {
            EXPECT_TRUE(device["software"].is_boolean());
            EXPECT_GE(device["max_texture_side_2d"].get<int>(), 1024);
            EXPECT_TRUE(contains(text, device["name"])) << text;
        }
    }
}

struct Refused {
    Arguments arguments;
    std::vector<std::string> said;  ///< all of it on one line
};

std::ostream& operator<<(std::ostream& stream, const Refused& refused) {
    return stream << testing::PrintToString(refused.arguments);
}

class Refusal : public Program, public testing::WithParamInterface<Refused> {};

TEST_P(Refusal, NamesValueAndRemedyOnOneLine) {
    const Outcome run = lumo(GetParam().arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(lines(run.err), 1) << run.err;
    for (const std::string& part : GetParam().said) EXPECT_TRUE(contains(run.err, part)) << run.err;
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, Refusal,
    testing::Values(
        Refused{{"view"}, {"view", "render, check, diff, devices, bench"}},
        Refused{{"render", "--storage", "list"}, {"--storage", "list", "available: vt, svo"}},
        Refused{{"render", "--mips", "none"}, {"--mips", "none", "available: iso, ani"}},
        Refused{{"render", "--range", "hdr"}, {"--range", "hdr", "available: auto, ldr"}},
        Refused{{"render", "--apertures", "wide"}, {"--apertures", "wide", "available: uniform, nonuniform"}},
        Refused{{"render", "--sky", "blue"}, {"--sky", "blue", "available: none, on"}},
        Refused{{"render", "--sky", "on", "--sun", "none"}, {"--sun", "a sky needs a sun"}},
        Refused{{"render", "--sky", "on", "--atmosphere", "no.json"}, {"no.json", "exist"}},
        Refused{{"render", "--altitude", "3"}, {"--altitude", "--sky on"}},
        Refused{{"render", "--sky", "on", "--altitude", "-1"}, {"--altitude", "'-1'", "kilometres"}},
        Refused{{"render", "--teapot"}, {"--teapot", "available:", "--cones"}},
        Refused{{"render", "--cones", "0"}, {"--cones", "'0'", "1 to 32"}},
        Refused{{"render", "--cones", "33"}, {"--cones", "'33'", "1 to 32"}},
        Refused{{"render", "--bounces", "0"}, {"--bounces", "'0'", "from 1"}},
        Refused{{"render", "--voxels", "100"}, {"--voxels", "'100'", "power of two from 16 to 1024"}},
        Refused{{"render", "--voxels", "8"}, {"'8'"}}, Refused{{"render", "--voxels", "2048"}, {"'2048'"}},
        Refused{{"render", "--size", "960"}, {"--size", "'960'", "WxH"}},
        Refused{{"render", "--size", "0x540"}, {"'0x540'"}},
        Refused{{"render", "--size", "20000x2"}, {"'20000x2'", "16384"}},
        Refused{{"render", "--layer", "normal,glow"}, {"'glow'", "irradiance", "depth"}},
        Refused{{"render", "--layer", "normal,normal"}, {"each layer once"}},
        Refused{{"render", "--tonemap", "filmic"}, {"'filmic'", "none, reinhard, hable, aces, agx"}},
        Refused{{"render", "--exposure", "bright"}, {"--exposure", "'bright'", "stops"}},
        Refused{{"render", "--ao-radius", "0"}, {"--ao-radius", "'0'", "metres"}},
        Refused{{"render", "--grid-size", "0"}, {"--grid-size", "'0'", "metres"}},
        Refused{{"render", "--api", "metal"}, {"'metal'", "vulkan, gl, both"}},
        Refused{{"render", "--plan", "none"}, {"auto, full"}},
        Refused{{"render", "--gi", "yes"}, {"on, off"}},
        Refused{{"render", "--materials", "toon"}, {"pbr, diffuse"}},
        Refused{{"render", "--sun", "1,2:3,4,5"}, {"--sun", "'1,2:3,4,5'", "dx,dy,dz:r,g,b"}},
        Refused{{"render", "--sun", "0,0,0:1,1,1"}, {"not zero"}},
        Refused{{"render", "--sun", "0,1,0:1,-1,1"}, {"0 or more"}},
        Refused{{"render", "--sun", "0,1,0:1,nan,1"}, {"nan"}},
        Refused{{"render", "--camera", "0,0,0:0,0,0:60"}, {"target"}},
        Refused{{"render", "--camera", "0,0,0:0,0,1:180"}, {"between 0 and 180"}},
        Refused{{"render", "cornell", "--camera", "nave"}, {"--camera", "'nave'", "px,py,pz:tx,ty,tz:FOV"}},
        Refused{{"render", "atrium", "--camera", "9"}, {"'9'", "0 'court'"}},
        Refused{{"render", "--frames", "0"}, {"--frames", "'0'"}},
        Refused{{"render", "--shard", "3/2"}, {"--shard", "'3/2'", "I/N"}},
        Refused{{"render", "heaven"}, {"heaven", ".gltf", "atrium, cornell, area-light"}},
        Refused{{"render", "missing.gltf"}, {"missing.gltf", "exist"}},
        Refused{{"check", "missing.glb"}, {"missing.glb", "exist"}},
        Refused{{"render", "cornell", "-o", "x.jpg"}, {"x.jpg", ".png", ".exr"}},
        Refused{{"render", "cornell", "-o", "no/folder/x.png"}, {"no/folder", "mkdir"}},
        Refused{{"render", "cornell", "--layer", "depth", "-o", "x.png"}, {"x.png", ".exr"}},
        Refused{{"render", "--config", "missing.json"}, {"missing.json"}},
        Refused{{"render", "cornell", "--device", "no such device"}, {"no such device"}},
        Refused{{"render", "cornell", "--sun-to", "0,1,0:1,1,1"}, {"--sun-to", "--sun"}},
        Refused{{"render", "one\x1b[31m.gltf"}, {"one?[31m.gltf"}}, Refused{{"diff", "a.png"}, {"B"}},
        Refused{{"diff", "a.png", "b.png"}, {"a.png"}}, Refused{{"devices", "--all"}, {"--all", "--json"}},
        Refused{{"probe", "slab"}, {"'slab'", "available: sky"}},
        Refused{{"probe", "sky", "--out", "x.csv"}, {"--in", "required"}},
        Refused{{"probe", "sky", "--orders", "0"}, {"--orders", "'0'", "1 to 1000, or all"}},
        Refused{{"probe", "sky", "--max-error", "2"}, {"--max-error", "'2'", "0 to 1"}},
        Refused{{"probe", "sky", "--in", "no.csv", "--out", "x.csv", "--reference"}, {"no.csv", "exist"}}));

TEST_F(CommandLine, ConfigRefusesWhatItDoesNotKnow) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"{", "not a JSON object"},
        {"[1]", "not a JSON object"},
        {R"({"voxel": 32})", "no setting 'voxel'"},
        {R"({"voxels": 33})", "power of two"},
        {R"({"voxels": [32]})", "power of two"},
        {R"({"storage": "list"})", "available: vt, svo"},
        {R"({"output": "x.png"})", "no setting 'output'"},
    };
    for (const auto& [text, said] : cases) {
        write("settings.json", text);
        const Outcome run = lumo({"render", "--config", "settings.json"});
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, "settings.json")) << run.err;
        EXPECT_TRUE(contains(run.err, said)) << run.err;
    }
}

}  // namespace
}  // namespace lumo::test
