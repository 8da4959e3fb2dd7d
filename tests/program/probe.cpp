// `lumo probe sky`: rows in, the same rows with answers out.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "program.hpp"

#include "scene/sky.hpp"

namespace lumo::test {
namespace {

constexpr std::string_view header =
    "quantity,camera_alt_km,view_zenith_deg,sun_zenith_deg,rel_azimuth_deg,distance_km\n";

constexpr std::string_view every_quantity =
    "transmittance_to_space,2,80,,,\n"
    "transmittance_segment,2,80,,,15\n"
    "radiance,0,60,40,30,\n"
    "radiance_order1,0,60,40,30,\n"
    "inscatter,0,60,40,30,10\n"
    "sky_irradiance,0,,40,,\n"
    "sun_irradiance,0,,40,,\n";

/// One wavelength, and what a test adds.
std::string atmosphere(const std::string& species) {
    return R"({"wavelengths_nm": [550], "radius_ground_km": 6360, "radius_top_km": 6420,
               "sun": {"irradiance": [1.5], "angular_radius_deg": 0.2678}, "ground_albedo": [0.1])" +
           species + "}";
}

std::string data(const std::string& name) { return LUMO_SOURCE_DIR "/tests/data/atmosphere/" + name; }

/// Lines of plain fields.
std::vector<std::vector<std::string>> fields(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line + ',');
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

class Probe : public Program {
  protected:
    /// The answer's table as text.
    std::string ask(const std::string& rows, const Arguments& more = {}) const {
        write("in.csv", rows);
        Arguments arguments{"probe", "sky", "--in", "in.csv", "--out", "out.csv"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome run = done(arguments);
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(run.err, "") << "no progress where there is no terminal";
        return bytes("out.csv");
    }
    /// By the reference, the first wavelength's values alone.
    std::vector<double> values(const std::string& rows, Arguments more = {}) const {
        more.insert(more.end(), {"--reference", "--samples", "4000"});
        std::vector<double> first;
        const auto table = fields(ask(std::string(header) + rows, more));
        for (size_t i = 1; i < table.size(); ++i) first.push_back(std::stod(table[i].at(6)));
        return first;
    }
};

TEST_F(Probe, KeepsColumnsAndRowsAsTheyWere) {
    const std::string rows =
        "note,distance_km,quantity,sun_zenith_deg,camera_alt_km,rel_azimuth_deg,view_zenith_deg\r\n"
        "\"a, \"\"b\"\"\n c\",10,transmittance_segment,,1,,90\r\n"
        "\r\n"
        ",,transmittance_to_space,not read,40,,0\n";
    const std::string answer = ask(rows, {"--reference", "--atmosphere", data("planetoid.json")});
    EXPECT_TRUE(answer.starts_with(
        "note,distance_km,quantity,sun_zenith_deg,camera_alt_km,rel_azimuth_deg,view_zenith_deg,value_0\n"
        "\"a, \"\"b\"\"\n c\",10,transmittance_segment,,1,,90,0."))
        << answer;
    EXPECT_TRUE(contains(answer, "\n,,transmittance_to_space,not read,40,,0,0.9")) << answer;
    EXPECT_EQ(lines(answer), 4);
}

TEST_F(Probe, ATableWithoutRowsIsAnswered) { EXPECT_EQ(ask(std::string(header), {"--reference"}), header); }

TEST_F(Probe, WhatIsSampledHasAnError) {
    const auto table =
        fields(ask(std::string(header) + std::string(every_quantity), {"--reference", "--samples", "4096"}));
    ASSERT_EQ(table.size(), 8);
    EXPECT_EQ(table[0].back(), "error_2");
    for (size_t i = 1; i < table.size(); ++i) {
        ASSERT_EQ(table[i].size(), 12);
        const bool sampled = i == 3 || i == 5 || i == 6;
        for (size_t w = 0; w < 3; ++w) {
            EXPECT_GT(std::stod(table[i][6 + w]), 0);
            EXPECT_EQ(table[i][9 + w].empty(), !sampled) << table[i][0];
            if (sampled) {
                EXPECT_LT(std::stod(table[i][9 + w]), 0.03 * std::stod(table[i][6 + w]));
            }
        }
    }
}

/// A sky's against the sum in double precision, and the sun's illuminance above the air.
TEST_F(Probe, LuminanceIsOfAllWavelengths) {
    const std::string rows =
        "radiance_order1,0,60,40,30,\nsun_irradiance,70,,0,,\ntransmittance_to_space,2,80,,,\n";
    const auto plain = fields(ask(std::string(header) + rows, {"--reference"}));
    const auto table = fields(ask(std::string(header) + rows, {"--reference", "--luminance"}));
    ASSERT_EQ(table[0].size(), plain[0].size() + 1);
    EXPECT_EQ(table[0].back(), "luminance");
    // Extraterrestrial illuminance: 133 klx (ASTM E-490).
    EXPECT_NEAR(std::stod(table[2].back()), 133e3, 0.04 * 133e3);
    EXPECT_EQ(table[3].back(), "");
    const std::vector<glm::dvec3> weights = scene::rgb_weights({680, 550, 440});
    double sum = 0;
    for (size_t i = 0; i < 3; ++i)
        sum += 683 * glm::dot(glm::dvec3(0.2126, 0.7152, 0.0722), weights[i]) * std::stod(table[1][6 + i]);
    EXPECT_NEAR(std::stod(table[1].back()), sum, 1e-4 * sum);
    EXPECT_GT(sum, 500) << "cd/m²: a clear sky";
}

TEST_F(Probe, ARowsAnswerIsTheSameInAnyTable) {
    const std::string row = "radiance,0,60,40,30,\n";
    const Arguments few{"--reference", "--samples", "9000", "--max-error", "0"};
    const std::string alone = ask(std::string(header) + row, few);
    const std::string among = ask(std::string(header) + std::string(every_quantity) + row, few);
    EXPECT_EQ(fields(alone)[1], fields(among)[3]);
    EXPECT_EQ(fields(alone)[1], fields(among)[8]);
}

TEST_F(Probe, SamplingEndsAtTheErrorAskedFor) {
    const auto error = [&](const char* asked) {
        const auto row = fields(ask(std::string(header) + "radiance,0,60,40,30,\n",
                                    {"--reference", "--max-error", asked, "--orders", "4"}))[1];
        return std::stod(row[11]) / std::stod(row[8]);
    };
    for (const double asked : {1e-3, 3e-4}) {
        const double reached = error(std::to_string(asked).c_str());
        EXPECT_LT(reached, asked);
        EXPECT_GT(reached, asked / 4) << "much more than was asked for";
    }
}

TEST_F(Probe, EachOrderAddsLight) {
    const std::string row = "radiance,0,60,40,30,\n";
    const double one = values(row, {"--orders", "1"})[0], two = values(row, {"--orders", "2"})[0],
                 four = values(row, {"--orders", "4"})[0], all = values(row)[0];
    EXPECT_EQ(one, values("radiance_order1,0,60,40,30,\n")[0]);
    EXPECT_GT(two, 1.02 * one);
    EXPECT_GT(four, 1.002 * two);
    EXPECT_GT(all, four);
    EXPECT_LT(all, 1.01 * four);
}

/// Ozone's density is a triangle of area 15 km.
TEST_F(Probe, AnAbsorberAloneDarkensAndScattersNothing) {
    write("a.json",
          atmosphere(
              R"(, "ozone": {"extinction_per_km": [0.02], "bottom_km": 10, "peak_km": 25, "top_km": 40})"));
    const auto found = values(
        "transmittance_to_space,0,0,,,\nsun_irradiance,0,,0,,\nradiance,0,60,40,30,\nsky_irradiance,0,,40,,\n"
        "inscatter,0,60,40,30,10\ntransmittance_segment,30,0,,,10\n",
        {"--atmosphere", "a.json"});
    EXPECT_NEAR(found[0], std::exp(-0.3), 1e-9);
    EXPECT_NEAR(found[1], 1.5 * std::exp(-0.3), 1e-9);
    EXPECT_EQ(found[2], 0);
    EXPECT_EQ(found[3], 0);
    EXPECT_EQ(found[4], 0);
    EXPECT_NEAR(found[5], std::exp(-0.02 * 100 / 30), 1e-9);
}

TEST_F(Probe, NoSpeciesAtAllIsEmptySpace) {
    write("a.json", atmosphere(""));
    EXPECT_EQ(values(std::string(every_quantity), {"--atmosphere", "a.json"}),
              (std::vector<double>{1, 1, 0, 0, 0, 0, 1.5 * std::sin(50 * M_PI / 180)}));
}

TEST_F(Probe, ExtremeRowsOfOtherPlanetsAreFiniteAndNotNegative) {
    std::string rows(header);
    for (const char* altitude : {"0", "0.000001", "50", "110", "10000"}) {
        for (const char* view : {"0", "90", "90.001", "180"}) {
            for (const char* sun : {"0", "90", "108"}) {
                for (const char* quantity : {"radiance", "transmittance_to_space", "inscatter"})
                    rows += fmt::format("{},{},{},{},0,0.5\n", quantity, altitude, view, sun);
            }
        }
    }
    for (const char* name : {"mars.json", "planetoid.json"}) {
        const auto table = fields(
            ask(rows, {"--reference", "--atmosphere", data(name), "--samples", "100", "--orders", "4"}));
        double most = 0;
        for (size_t i = 1; i < table.size(); ++i) {
            const double value = std::stod(table[i].at(6));
            ASSERT_TRUE(std::isfinite(value) && value >= 0) << testing::PrintToString(table[i]);
            most = std::max(most, value);
        }
        EXPECT_EQ(most, 1) << "nothing in the way";
    }
}

TEST_F(Probe, WrongTablesAreNamedByLineColumnAndValue) {
    struct Case {
        std::string text;
        std::vector<std::string> said;
    };
    const std::string begin(header);
    const std::vector<Case> cases{
        {"", {"is empty"}},
        {"quantity,camera_alt_km\nradiance,0\n", {"no column view_zenith_deg", "add it"}},
        {"camera_alt_km\n0\n", {"no column quantity"}},
        {"quantity,quantity\n", {"line 1", "two columns are called 'quantity'"}},
        {"quantity,,\n", {"line 1", "no name"}},
        {begin + "luminance,0,0,0,0,0\n", {"line 2, column quantity", "'luminance'", "radiance_order1"}},
        {begin + "radiance,0,0,0,0,\nradiance,-1,0,0,0,\n",
         {"line 3, column camera_alt_km", "'-1'", "0 to 1e+06"}},
        {begin + "\nradiance,0,181,0,0,\n", {"line 3, column view_zenith_deg", "'181'", "0 to 180"}},
        {begin + "radiance,0,0,,0,\n", {"line 2, column sun_zenith_deg", "''", "0 to 180"}},
        {begin + "radiance,0,0,0,north,\n", {"line 2, column rel_azimuth_deg", "'north'"}},
        {begin + "radiance,0,0,0,nan,\n", {"line 2, column rel_azimuth_deg", "'nan'"}},
        {begin + "inscatter,0,0,0,0,inf\n", {"line 2, column distance_km", "'inf'"}},
        {begin + "inscatter,0,0,0,0,1e999\n", {"line 2, column distance_km", "'1e999'"}},
        {begin + "inscatter,0,0,0,0,\x1b[31m\n", {"line 2, column distance_km", "'?[31m'"}},
        {begin + "radiance,0,0,0,0\n", {"line 2", "has 5 fields", "give 6"}},
        {begin + "\"radiance\"x,0,0,0,0,\n", {"line 2", "quote"}},
        {begin + "radiance,0,0,0,0,\"\n\n", {"line 3", "quote"}},
        {"value_0," + begin + "1,radiance,0,0,0,0,\n", {"value_0 already", "rename"}},
    };
    for (const Case& wrong : cases) {
        write("in.csv", wrong.text);
        const Outcome run =
            lumo({"probe", "sky", "--in", "in.csv", "--out", "out.csv", "--reference", "--samples", "1"});
        EXPECT_EQ(run.exit_code, 2) << wrong.text;
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, "in.csv")) << run.err;
        for (const std::string& part : wrong.said) EXPECT_TRUE(contains(run.err, part)) << run.err;
        EXPECT_FALSE(std::filesystem::exists(path("out.csv"))) << wrong.text;
    }
}

TEST_F(Probe, WrongAtmospheresAreNamedByFieldAndValue) {
    write("in.csv", std::string(header));
    const std::vector<std::pair<std::string, std::string>> cases{
        {"{", "is not JSON"},
        {"{}", "is missing"},
        {atmosphere(R"(, "rayleigh": {"scattering_per_km": [1, 2], "scale_height_km": 8})"),
         "rayleigh.scattering_per_km has 2 values"},
        {atmosphere(R"(, "clouds": {})"), "'clouds'"},
    };
    for (const auto& [text, said] : cases) {
        write("a.json", text);
        const Outcome run = lumo(
            {"probe", "sky", "--in", "in.csv", "--out", "out.csv", "--atmosphere", "a.json", "--reference"});
        EXPECT_EQ(run.exit_code, 2) << text;
        EXPECT_EQ(lines(run.err), 1) << run.err;
        EXPECT_TRUE(contains(run.err, "a.json") && contains(run.err, said)) << run.err;
    }
}

class ProbeOnApi : public Probe, public testing::WithParamInterface<const char*> {
  protected:
    /// On the GPU with small tables: by row and wavelength.
    std::vector<std::vector<double>> answers(const std::string& rows, Arguments more = {}) const {
        write("in.csv", std::string(header) + rows);
        Arguments arguments{"probe",   "sky",      "--in", "in.csv", "--out",   "out.csv",
                            "--quiet", "--preset", "fast", "--api",  GetParam()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        done(arguments);
        std::vector<std::vector<double>> all;
        const auto table = fields(bytes("out.csv"));
        for (size_t i = 1; i < table.size(); ++i) {
            all.emplace_back();
            for (size_t w = 6; w < table[i].size(); ++w) all.back().push_back(std::stod(table[i][w]));
        }
        return all;
    }
};

INSTANTIATE_TEST_SUITE_P(Apis, ProbeOnApi, testing::Values("vulkan", "gl"));

TEST_P(ProbeOnApi, AnswersLikeTheReference) {
    const std::string rows(every_quantity);
    const auto found = answers(rows, {"--orders", "4"});
    const auto truth = fields(ask(std::string(header) + rows, {"--reference", "--orders", "4"}));
    ASSERT_EQ(found.size(), 7);
    const std::vector<double> within{1e-3, 1e-3, 0.02, 0.005, 0.02, 0.02, 1e-3};
    for (size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].size(), 3);
        for (size_t w = 0; w < 3; ++w) {
            const double exact = std::stod(truth[i + 1][6 + w]);
            EXPECT_NEAR(found[i][w], exact, within[i] * exact) << truth[i + 1][0] << ' ' << w;
        }
    }
}

TEST_P(ProbeOnApi, EachOrderAddsLight) {
    const std::string row = "radiance,0,60,40,30,\n";
    std::vector<double> by_orders;
    for (const char* orders : {"1", "2", "4", "all"})
        by_orders.push_back(answers(row, {"--orders", orders})[0][2]);
    EXPECT_TRUE(std::ranges::is_sorted(by_orders)) << testing::PrintToString(by_orders);
    EXPECT_FLOAT_EQ(float(by_orders[0]), float(answers("radiance_order1,0,60,40,30,\n")[0][2]));
    EXPECT_GT(by_orders[1], 1.2 * by_orders[0]);
    EXPECT_LT(by_orders[3], 1.02 * by_orders[2]);
}

/// More than the four that one table holds: the fifth is the first again.
TEST_P(ProbeOnApi, ManyWavelengthsAreAnsweredInGroups) {
    write("a.json", R"({"wavelengths_nm": [680, 600, 550, 500, 680], "radius_ground_km": 6360,
        "radius_top_km": 6420, "sun": {"irradiance": [1, 2, 3, 4, 1], "angular_radius_deg": 0.27},
        "rayleigh": {"scattering_per_km": [0.006, 0.01, 0.014, 0.02, 0.006], "scale_height_km": 8},
        "ground_albedo": [0.1, 0.2, 0.3, 0.4, 0.1]})");
    for (const auto& row : answers(std::string(every_quantity), {"--atmosphere", "a.json"})) {
        ASSERT_EQ(row.size(), 5);
        EXPECT_NEAR(row[0], row[4], 1e-3 * row[0]) << "pieces of rays depend on the group";
        EXPECT_NE(row[0], row[3]);
    }
}

TEST_P(ProbeOnApi, SpeciesMayBeMissing) {
    write("none.json", atmosphere(""));
    const auto none = answers(std::string(every_quantity), {"--atmosphere", "none.json"});
    const std::vector<double> expected{1, 1, 0, 0, 0, 0, 1.5 * std::sin(50 * M_PI / 180)};
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(none[i][0], expected[i], 1e-6) << i;

    write("ozone.json",
          atmosphere(
              R"(, "ozone": {"extinction_per_km": [0.02], "bottom_km": 10, "peak_km": 25, "top_km": 40})"));
    const auto ozone =
        answers("transmittance_to_space,0,0,,,\nradiance,0,60,40,30,\nsky_irradiance,0,,40,,\n",
                {"--atmosphere", "ozone.json"});
    EXPECT_NEAR(ozone[0][0], std::exp(-0.3), 1e-4);
    EXPECT_EQ(ozone[1][0], 0);
    EXPECT_EQ(ozone[2][0], 0);
}

TEST_P(ProbeOnApi, ExtremeRowsOfOtherPlanetsAreFiniteAndNotNegative) {
    std::string rows;
    for (const char* altitude : {"0", "0.000001", "50", "120", "10000"}) {
        for (const char* view : {"0", "89.9999", "90", "90.001", "180"}) {
            for (const char* sun : {"0", "90", "108", "180"}) {
                for (const std::string_view quantity :
                     {"radiance", "transmittance_to_space", "inscatter", "sky_irradiance", "sun_irradiance"})
                    rows += fmt::format("{},{},{},{},0,0.5\n", quantity, altitude, view, sun);
            }
        }
    }
    for (const char* name : {"mars.json", "planetoid.json"}) {
        const auto found = answers(rows, {"--atmosphere", data(name)});
        const auto table = fields(rows);
        for (size_t i = 0; i < found.size(); ++i)
            for (const double value : found[i])
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << name << testing::PrintToString(table[i]);
    }
}

/// Of what is stored, a damaged file is as good as none, and is made again.
TEST_P(ProbeOnApi, TablesAreKeptAndDamagedOnesMadeAgain) {
    write("in.csv", std::string(header) + "radiance,0,60,40,30,\n");
    const auto answer = [&] {
        const Outcome run = lumo(
            {"probe", "sky", "--in", "in.csv", "--out", "out.csv", "--preset", "fast", "--api", GetParam()},
            {{"XDG_CACHE_HOME", path("cache").string()}});
        EXPECT_EQ(run.exit_code, 0) << run.err;
        return bytes("out.csv");
    };
    const auto files = [&] {
        std::vector<std::string> all;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("cache")))
            if (entry.is_regular_file()) all.push_back(entry.path().string());
        std::ranges::sort(all);
        return all;
    };
    const std::string first = answer();
    const auto stored = files();
    ASSERT_FALSE(stored.empty());
    EXPECT_EQ(answer(), first) << "from the cache";
    EXPECT_EQ(files(), stored) << "nothing was made again";
    // Far greater than all that drivers keep.
    const std::string tables = *std::ranges::max_element(
        stored, {}, [](const std::string& f) { return std::filesystem::file_size(f); });
    const auto size = std::filesystem::file_size(tables);
    std::filesystem::resize_file(tables, size / 2);
    EXPECT_EQ(answer(), first);
    EXPECT_EQ(files(), stored);
    EXPECT_EQ(std::filesystem::file_size(tables), size);
}

TEST_F(Probe, BothApisIntoTwoFiles) {
    write("in.csv", std::string(header) + std::string(every_quantity));
    done({"probe", "sky", "--in", "in.csv", "--out", "out.csv", "--preset", "fast", "--api", "both"});
    EXPECT_FALSE(std::filesystem::exists(path("out.csv")));
    const auto gl = fields(bytes("out.gl.csv")), vulkan = fields(bytes("out.vulkan.csv"));
    ASSERT_EQ(gl.size(), 8);
    ASSERT_EQ(vulkan.size(), 8);
    EXPECT_EQ(gl[0], vulkan[0]);
    for (size_t i = 1; i < 8; ++i) {
        for (size_t w = 6; w < 9; ++w) {
            const double a = std::stod(gl[i].at(w)), b = std::stod(vulkan[i].at(w));
            EXPECT_NEAR(a, b, 1e-4 * a) << gl[i][0];
        }
    }
}

}  // namespace
}  // namespace lumo::test
