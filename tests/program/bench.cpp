// lumo bench: that it measures what it says. How fast anything is, no test decides.
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
