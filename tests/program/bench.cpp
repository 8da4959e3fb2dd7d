// lumo bench: that it measures what it says. How fast anything is, no test decides.
#include <fmt/format.h>
#include <map>

#include "program.hpp"

namespace lumo::test {
namespace {

class Bench : public Program {};

void expect_spread(const nlohmann::json& spread) {
    EXPECT_GT(spread["min"].get<double>(), 0);
    EXPECT_LE(spread["min"].get<double>(), spread["median"].get<double>());
    EXPECT_LE(spread["median"].get<double>(), spread["max"].get<double>());
}

TEST_F(Bench, RhiMeasuresBothApisAgainstTheirOwnCalls) {
    const Outcome run = done({"bench", "rhi", "--runs", "1", "--json"});
    EXPECT_EQ(run.err, "");
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json["benchmark"], "rhi");
    EXPECT_EQ(json["runs"], 1);
    ASSERT_EQ(json["apis"].size(), 2u);
    EXPECT_EQ(json["apis"][0]["api"], "vulkan");
    EXPECT_EQ(json["apis"][1]["api"], "gl");
    for (const auto& api : json["apis"]) {
        EXPECT_NE(api["device"], "");
        EXPECT_NE(api["driver"], "");
        ASSERT_EQ(api["cpu"].size(), 2u);
        for (const auto& calls : api["cpu"]) {
            expect_spread(calls["lumo_us"]);
            expect_spread(calls["straight_us"]);
            expect_spread(calls["ratio"]);
            EXPECT_EQ(calls["met"], calls["ratio"]["median"] <= calls["aim"]);
        }
        ASSERT_EQ(api["bandwidth"].size(), 4u);
        for (const auto& transfer : api["bandwidth"]) {
            expect_spread(transfer["lumo_gib_per_s"]);
            expect_spread(transfer["straight_gib_per_s"]);
        }
        const auto& passes = api["pass_times"];
        EXPECT_GE(passes["wall_ms"]["median"], 500);
        EXPECT_LE(passes["sum_over_wall"]["max"], 1)
            << "passes that follow each other take no longer than all";
    }
}

TEST_F(Bench, RhiAsATable) {
    const Outcome run = done({"bench", "rhi", "--api", "gl", "--runs", "1", "--quiet"});
    for (const char* part : {"dispatch", "draw", "upload buffer", "read texture", "over wall"})
        EXPECT_TRUE(contains(run.out, part)) << run.out;
    EXPECT_FALSE(contains(run.out, "vulkan")) << run.out;
}

TEST_F(Bench, VoxelsMeasuresEveryRowInItsOwnConfiguration) {
    const Outcome run = done({"bench", "voxels", "cornell", "--api", "gl", "--runs", "1", "--voxels", "32",
                              "--size", "32x18", "--quiet", "--json"});
    const auto json = nlohmann::json::parse(run.out);
    ASSERT_EQ(json["apis"].size(), 1u);
    std::map<std::string, uint64_t> bytes;
    for (const auto& row : json["apis"][0]["rows"]) {
        for (const char* column : {"V", "RI", "CT_3", "CT_9", "CT_18"}) expect_spread(row["ms"][column]);
        EXPECT_EQ(row["range"], contains(row["row"].get<std::string>(), "HDR") ? "fixed" : "ldr");
        bytes[row["row"]] = row["voxel_bytes"];
    }
    ASSERT_EQ(bytes.size(), 8u);
    // Half floats take twice the room of 8 bits, six directions more than none.
    for (const char* layout : {"VT ISO", "VT ANI", "SVO ISO", "SVO ANI"})
        EXPECT_GT(bytes[fmt::format("{} HDR 32", layout)], bytes[fmt::format("{} LDR 32", layout)]) << layout;
    EXPECT_GT(bytes["VT ANI LDR 32"], bytes["VT ISO LDR 32"]);
    EXPECT_EQ(json["apis"][0]["ratios"].size(), 6u);
}

TEST_F(Bench, MemoryCountsNodesOfEveryDimension) {
    const Outcome run = done({"bench", "memory", "cornell", "--voxels", "64", "--quiet", "--json"});
    const auto json = nlohmann::json::parse(run.out);
    ASSERT_EQ(json["apis"].size(), 2u);
    EXPECT_EQ(json["apis"][0]["rows"], json["apis"][1]["rows"]) << "both APIs mark the same voxels";
    const auto& rows = json["apis"][0]["rows"];
    ASSERT_EQ(rows.size(), 2u);
    // Surfaces: four times the voxels where there are twice as many a side.
    const double small = rows[0]["occupied"][0], large = rows[1]["occupied"][0];
    EXPECT_NEAR(large / small, 4, 0.5);
    EXPECT_GT(rows[1]["nodes_as_the_paper_counts"], rows[0]["nodes_as_the_paper_counts"]);
}

TEST_F(Bench, RefusesWhatItCannotMeasure) {
    const std::vector<std::pair<Arguments, std::string>> cases{
        {{"bench"}, "NAME"},
        {{"bench", "everything"}, "available: "},
        {{"bench", "rhi", "--runs", "0"}, "1 to 1000"},
        {{"bench", "rhi", "--device", "no such device"}, "no such device"},
    };
    for (const auto& [arguments, said] : cases) {
        const Outcome run = lumo(arguments);
        EXPECT_EQ(run.exit_code, 2) << said;
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, said)) << run.err;
    }
}

}  // namespace
}  // namespace lumo::test
