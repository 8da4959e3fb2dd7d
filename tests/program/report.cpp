// lumo report: that what it writes agrees with itself, and that nothing is done twice.
#include <cstdlib>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <map>
#include <set>
#include <sstream>
#include <sys/stat.h>

#include "program.hpp"

namespace lumo::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

size_t count(const std::string& text, const std::string& part) {
    size_t found = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) all.push_back(line);
    return all;
}

/// A line of CSV by the names in the head. No field of these tests has quotes in it.
std::map<std::string, std::string> fields(const std::string& head, const std::string& line) {
    const auto split = [](const std::string& text) {
        std::vector<std::string> parts(1);
        bool quoted = false;
        for (const char c : text) {
            if (c == '"')
                quoted = !quoted;
            else if (c == ',' && !quoted)
                parts.emplace_back();
            else
                parts.back() += c;
        }
        return parts;
    };
    const auto names = split(head), values = split(line);
    EXPECT_EQ(names.size(), values.size()) << line;
    std::map<std::string, std::string> result;
    for (size_t i = 0; i < std::min(names.size(), values.size()); ++i) result[names[i]] = values[i];
    return result;
}

class Report : public Program {
  protected:
    /// A small report of a scene, into the folder `to`; its default is among what --vary names.
    static Arguments small(const std::string& scene, const std::string& to, const Arguments& more = {}) {
        Arguments all{"report",  scene,    "--size", "32x18",       "--voxels", "16",     "--cones",
                      "3",       "--rays", "16",     "--spp",       "4",        "--runs", "2",
                      "--quiet", "-o",     to,       "--materials", "diffuse"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    Environment own_cache() const { return {{"XDG_CACHE_HOME", path("cache").string()}}; }
    bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }

    Outcome succeeds(const Arguments& arguments, const Environment& environment = {}) const {
        const Outcome run = lumo(arguments, environment);
        EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
        return run;
    }
};

TEST_F(Report, FilesAgreeWithEachOtherOnBothApis) {
    const Outcome run = succeeds(
        small("cornell", "out", {"--api", "both", "--vary", "cones=3,6", "--also", "mips=iso,bounces=2"}));
    EXPECT_EQ(run.err, "");
    EXPECT_THAT(run.out, HasSubstr("out/index.html"));
    const Json report = json("out/report.json");
    const auto csv = lines_of(bytes("out/report.csv"));
    const std::string page = bytes("out/index.html");

    ASSERT_EQ(report["devices"].size(), 2);
    EXPECT_EQ(report["references"].size(), 3) << "1 bounce, 2, all";
    ASSERT_EQ(csv.size(), 1 + 2 * 3);
    EXPECT_EQ(count(page, "<tr class="), 2 * 3);
    size_t line = 1;
    std::map<std::string, Json> by_api;
    for (const Json& device : report["devices"]) {
        EXPECT_NE(device["device"], "");
        EXPECT_NE(device["driver"], "");
        ASSERT_EQ(device["configurations"].size(), 3);
        std::set<std::string> settings;
        int defaults = 0;
        for (const Json& row : device["configurations"]) {
            const auto fields_of_row = fields(csv[0], csv[line++]);
            EXPECT_EQ(fields_of_row.at("api"), device["api"]);
            EXPECT_EQ(fields_of_row.at("device"), device["device"]);
            for (const auto& [name, value] : row["settings"].items())
                EXPECT_EQ(fields_of_row.at(name), value) << name;
            const double rmse = row["errors"]["irradiance"]["relative_rmse"];
            EXPECT_NEAR(std::stod(fields_of_row.at("irradiance_relative_rmse")), rmse, 1e-5 * rmse);
            EXPECT_NEAR(std::stod(fields_of_row.at("gpu_ms")), row["gpu_ms"], 1e-5 * double(row["gpu_ms"]));
            EXPECT_EQ(std::stoull(fields_of_row.at("bytes")), row["bytes"]);
            EXPECT_THAT(page, HasSubstr(fmt::format("<td>{:.2f}</td>", 100 * rmse)));
            EXPECT_THAT(page, HasSubstr(fmt::format("<td>{:.2f}</td>", double(row["gpu_ms"]))));
            // The parts make up the whole.
            uint64_t memory = 0;
            for (const Json& entry : row["memory"]) memory += uint64_t(entry);
            EXPECT_EQ(memory, row["bytes"]);
            EXPECT_GT(row["gpu_ms"], 0);
            EXPECT_TRUE(row["passes"].contains("cones.irradiance"));
            EXPECT_GT(row["floor_relative_rmse"], 0);
            EXPECT_NE(row["errors"], row["errors_all_bounces"]);
            settings.insert(row["settings"].dump());
            defaults += row["default"] == true;
            by_api[device["api"]].push_back(row["errors"]["irradiance"]["relative_rmse"]);
        }
        EXPECT_EQ(settings.size(), 3) << "each combination once";
        EXPECT_EQ(defaults, 1);
        EXPECT_GT(device["nothing_left_out"]["bytes"], device["configurations"][0]["bytes"]);
    }
    for (size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(by_api["vulkan"][i], by_api["gl"][i], 1e-4) << "both APIs draw the same picture";
}

/// A scene with a sky has a table of what that costs, and no other has.
TEST_F(Report, SaysWhatTheSkyCosts) {
    const Arguments all = small("sky", "out", {"--api", "gl", "--preset", "fast", "--also", "cones=4"});
    succeeds(all, own_cache());
    const Json report = json("out/report.json");
    const auto csv = lines_of(bytes("out/sky.csv"));
    const std::string page = bytes("out/index.html");
    ASSERT_EQ(csv.size(), 1 + 1);
    EXPECT_THAT(page, HasSubstr("The sky's tables"));
    size_t line = 1;
    for (const Json& device : report["devices"]) {
        ASSERT_EQ(device["sky"].size(), 1) << "up to the frame's preset";
        const Json& sky = device["sky"][0];
        const auto row = fields(csv[0], csv[line++]);
        EXPECT_EQ(row.at("api"), device["api"]);
        EXPECT_EQ(row.at("preset"), "fast");
        EXPECT_EQ(std::stoull(row.at("bytes")), sky["bytes"]);
        EXPECT_NEAR(std::stod(row.at("precomputation_ms")), sky["precomputation_ms"],
                    1e-5 * double(sky["precomputation_ms"]));
        EXPECT_GT(sky["ns_per_pixel"], 0);
        for (const char* name : {"order1", "radiance", "irradiance"}) {
            const Json& error = sky[name];
            EXPECT_EQ(error["noise"] == 0, name == std::string("order1")) << "what is exact has no noise";
            EXPECT_GT(error["worst"], 0) << name;
            EXPECT_LE(error["median"], error["worst"]);
            EXPECT_LT(double(error["worst"]), 0.05 + 4 * double(error["noise"])) << name;
            EXPECT_NEAR(std::stod(row.at(std::string(name) + "_worst")), error["worst"],
                        1e-5 * double(error["worst"]));
        }
        EXPECT_THAT(page, HasSubstr(fmt::format("<td>{:.2f}</td>", 100 * double(sky["radiance"]["worst"]))));
    }
    succeeds(all, own_cache());
    EXPECT_EQ(json("out/report.json"), report) << "nothing is measured twice";
    succeeds(small("cornell", "none", {"--api", "gl", "--also", "cones=4"}));
    EXPECT_FALSE(exists("none/sky.csv"));
    EXPECT_THAT(bytes("none/index.html"), Not(HasSubstr("The sky's tables")));
}

TEST_F(Report, MarksAsFrontWhatNothingBeats) {
    succeeds(small("cornell", "out", {"--api", "gl", "--vary", "voxels=16,32", "--vary", "cones=3,6"}));
    const Json report = json("out/report.json");
    const Json& rows = report["devices"][0]["configurations"];
    for (const Json& row : rows) {
        bool beaten = false;
        for (const Json& other : rows)
            beaten |= other != row && other["gpu_ms"] <= row["gpu_ms"] &&
                      other["errors"]["irradiance"]["relative_rmse"] <=
                          row["errors"]["irradiance"]["relative_rmse"];
        EXPECT_EQ(row["on_front"], !beaten) << row["label"];
    }
}

TEST_F(Report, ThePageNeedsNoOtherFile) {
    succeeds(small("cornell", "out", {"--api", "gl", "--vary", "cones=3,6"}));
    const std::string page = bytes("out/index.html");
    EXPECT_EQ(count(page, "<img "), count(page, "src=\"data:image/png;base64,"));
    EXPECT_GE(count(page, "<img "), 5);
    EXPECT_THAT(page, Not(HasSubstr("<script")));
    EXPECT_THAT(page, Not(HasSubstr("<link")));
    if (std::system("command -v gnuplot >/dev/null") != 0) GTEST_SKIP() << "there is no gnuplot";
    EXPECT_EQ(count(page, "<svg"), 3);
    for (const char* name : {"error-time.gl.svg", "passes.gl.svg", "memory.svg"})
        EXPECT_THAT(bytes(std::string("out/") + name), HasSubstr("</svg>")) << name;
    EXPECT_THAT(bytes("out/error-time.gl.svg"), HasSubstr("Pareto front"));
}

TEST_F(Report, GoesOnWhereItWasEnded) {
    const Arguments all = small("cornell", "out", {"--api", "gl", "--vary", "cones=3,4,5,6,7,8"});
    std::string script = fmt::format("cd '{}'; export LUMO_VALIDATION=1 XDG_CACHE_HOME='{}'\n'{}'",
                                     path("").string(), LUMO_TEST_CACHE, LUMO_PROGRAM);
    for (const std::string& word : all) script += " " + word;
    // Ended without warning once it has measured something.
    script +=
        " >/dev/null &\nwhile ! [ -s out/measured.jsonl ] && kill -0 $!; do sleep 0.01; done\nkill -9 $!\n";
    write("ended.sh", script);
    EXPECT_NE(std::system(fmt::format("bash '{}'", path("ended.sh").string()).c_str()), -1);
    const auto before = lines_of(bytes("out/measured.jsonl"));
    ASSERT_GE(before.size(), 1);
    EXPECT_FALSE(exists("out/report.json"));

    // A line that was torn is measured again, and what comes after it is not lost.
    write("out/measured.jsonl", bytes("out/measured.jsonl") + before[0].substr(0, before[0].size() / 2));
    succeeds(all);
    const Json report = json("out/report.json");
    std::set<double> times;
    for (const Json& row : report["devices"][0]["configurations"]) times.insert(double(row["gpu_ms"]));
    EXPECT_EQ(times.size(), 6);
    EXPECT_TRUE(times.contains(double(Json::parse(before[0])["gpu_ms"]))) << "what was measured is taken";
    for (const std::string& line : lines_of(bytes("out/measured.jsonl")))
        EXPECT_TRUE(Json::accept(line)) << line;

    const std::string measured = bytes("out/report.json");
    succeeds(all);
    EXPECT_EQ(bytes("out/report.json"), measured) << "the third time nothing is measured";
}

TEST_F(Report, TheReferenceIsTracedOnceAndWhatIsDamagedIsReplaced) {
    const auto entries = [&] {
        std::map<std::string, std::pair<ino_t, std::string>> found;
        for (const auto& entry : std::filesystem::directory_iterator(path("cache/lumo/reference"))) {
            struct stat status {};
            stat(entry.path().c_str(), &status);
            const std::string name = entry.path().filename();
            found[name] = {status.st_ino, bytes("cache/lumo/reference/" + name)};
        }
        return found;
    };
    const auto report = [&](const char* to) {
        succeeds(small("cornell", to, {"--api", "gl", "--also", "cones=4"}), own_cache());
    };
    report("first");
    const auto first = entries();
    ASSERT_EQ(first.size(), 2) << "1 bounce, and all";
    report("second");
    EXPECT_EQ(entries(), first) << "nothing was written, and so nothing traced";
    EXPECT_EQ(json("second/report.json")["references"], json("first/report.json")["references"]);

    const std::string& name = first.begin()->first;
    std::string damaged = first.begin()->second.second;
    damaged[damaged.size() / 2] ^= 1;
    write("cache/lumo/reference/" + name, damaged);
    report("third");
    EXPECT_EQ(entries()[name].second, first.begin()->second.second);
    EXPECT_EQ(json("third/report.json")["references"], json("first/report.json")["references"]);
}

TEST_F(Report, NamesFromFilesAreTextOnThePage) {
    const std::string name = "<img src=x onerror=alert(1)> &'\"";
    write(name + ".gltf",
          fmt::format(R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], {}}})",
                      triangle_accessor));
    succeeds(small(name + ".gltf", "out", {"--api", "gl", "--also", "cones=4"}));
    const std::string page = bytes("out/index.html");
    EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
    EXPECT_THAT(page, HasSubstr("&lt;img src=x onerror=alert(1)&gt; &amp;&#39;&quot;.gltf"));
    EXPECT_EQ(json("out/report.json")["scene"], name + ".gltf");
}

TEST_F(Report, WithoutGnuplotAllElseIsThere) {
    const Outcome run =
        succeeds(small("cornell", "out", {"--api", "gl", "--also", "cones=4"}), {{"PATH", "/nowhere"}});
    EXPECT_THAT(run.err, HasSubstr("gnuplot-nox"));
    EXPECT_EQ(lines(run.err), 1);
    EXPECT_THAT(bytes("out/index.html"), HasSubstr("gnuplot-nox"));
    EXPECT_TRUE(exists("out/report.csv"));
    EXPECT_FALSE(exists("out/error-time.gl.svg"));
}

TEST_F(Report, RefusesWhatItCannotVaryBeforeAnyWork) {
    write("file", "");
    const std::vector<std::pair<Arguments, std::string>> cases{
        {{"--vary", "voxels"}, "NAME=V1,V2"},
        {{"--vary", "voxels=64,65"}, "'65'"},
        {{"--vary", "teapots=1"}, "available: gi"},
        {{"--vary", "materials=pbr,diffuse"}, "'materials'"},
        {{"--also", "cones"}, "NAME=V,NAME=V"},
        {{"--also", "cones=64"}, "1 to 32"},
        {{"--layer", "albedo"}, "albedo"},
        {{"--spp", "1"}, "2"},
        {{"-o", "file"}, "file"},
    };
    for (const auto& [arguments, said] : cases) {
        Arguments all{"report", "cornell"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome run = lumo(all);
        EXPECT_EQ(run.exit_code, 2) << said;
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_THAT(run.err, HasSubstr(said));
    }
    EXPECT_FALSE(exists("cornell-report"));
}

}  // namespace
}  // namespace lumo::test
