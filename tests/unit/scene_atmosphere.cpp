// The atmosphere's parameters and their file.
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene/atmosphere.hpp"

namespace lumo::scene {
namespace {

constexpr std::string_view earth_text = R"(
{"wavelengths_nm": [680, 550, 440], "radius_ground_km": 6360, "radius_top_km": 6420,
 "sun": {"irradiance": [1.474, 1.8504, 1.91198], "angular_radius_deg": 0.2678},
 "rayleigh": {"scattering_per_km": [0.0058, 0.0136, 0.0331], "scale_height_km": 8},
 "mie": {"scattering_per_km": [0.003996, 0.003996, 0.003996], "extinction_per_km": [0.00444, 0.00444, 0.00444],
         "scale_height_km": 1.2, "g": 0.8},
 "ozone": {"extinction_per_km": [0.00065, 0.00188, 0.000085], "bottom_km": 10, "peak_km": 25, "top_km": 40},
 "ground_albedo": [0.1, 0.1, 0.1]})";

TEST(AtmosphereFile, TheExampleIsEarth) {
    const auto read = parse_atmosphere(earth_text, "earth.json");
    ASSERT_TRUE(read) << to_string(read.error());
    const Atmosphere a = earth();
    EXPECT_EQ(read->wavelengths_nm, a.wavelengths_nm);
    EXPECT_EQ(read->radius_top_km, a.radius_top_km);
    EXPECT_EQ(read->sun_irradiance, a.sun_irradiance);
    EXPECT_EQ(read->rayleigh->scattering_per_km, a.rayleigh->scattering_per_km);
    EXPECT_EQ(read->mie->extinction_per_km, a.mie->extinction_per_km);
    EXPECT_EQ(read->mie->g, a.mie->g);
    EXPECT_EQ(read->ozone->peak_km, a.ozone->peak_km);
    EXPECT_TRUE(check(a, "earth"));
}

TEST(AtmosphereFile, AnySpeciesMayBeMissing) {
    for (const char* name : {"rayleigh", "mie", "ozone"}) {
        auto json = nlohmann::json::parse(earth_text);
        json.erase(name);
        EXPECT_TRUE(parse_atmosphere(json.dump(), "a.json")) << name;
    }
}

TEST(AtmosphereFile, ErrorsNameFieldValueAndRemedy) {
    struct Case {
        const char *pointer, *value, *said;
    };
    for (const auto& [pointer, value, said] : {
             Case{"/radius_top_km", "6360", "radius_top_km is 6360"},
             Case{"/radius_ground_km", "-1", "radius_ground_km is -1"},
             Case{"/radius_ground_km", "1e300", "radius_ground_km is 1e+300"},
             Case{"/wavelengths_nm", "[]", "wavelengths_nm has 0 values"},
             Case{"/wavelengths_nm", "7", "wavelengths_nm is 7"},
             Case{"/ground_albedo", "[0.1, 0.1]", "ground_albedo has 2 values"},
             Case{"/ground_albedo/1", "1.5", "ground_albedo[1] is 1.5"},
             Case{"/mie/g", "1", "mie.g is 1"},
             Case{"/mie/scattering_per_km/2", "0.005", "mie.scattering_per_km[2] is 0.005"},
             Case{"/rayleigh/scale_height_km", "0", "rayleigh.scale_height_km is 0"},
             Case{"/rayleigh/scale_height_km", "\"8\"", "rayleigh.scale_height_km is \"8\""},
             Case{"/ozone/peak_km", "9", "10, 9 and 40"},
             Case{"/sun", "[]", "sun is an array"},
             Case{"/sun/irradiance/0", "-1", "sun.irradiance[0] is -1"},
             Case{"/mie/albedo", "1", "'mie.albedo'"},
         }) {
        auto json = nlohmann::json::parse(earth_text);
        json[nlohmann::json::json_pointer(pointer)] = nlohmann::json::parse(value);
        const auto read = parse_atmosphere(json.dump(), "a.json");
        ASSERT_FALSE(read) << pointer;
        EXPECT_THAT(read.error().message, testing::HasSubstr(said));
        EXPECT_EQ(read.error().subject, "a.json");
        EXPECT_FALSE(read.error().remedy.empty());
    }
    for (const char* text : {"", "[", "null", "3", "{}", "{\"sun\": 1e999}"})
        EXPECT_FALSE(parse_atmosphere(text, "a.json")) << text;
    const std::string deep(500'000, '[');
    const std::string closed = deep + std::string(500'000, ']');
    for (const std::string& text :
         {deep, closed, "{\"sun\": " + closed + "}", "{\"ground_albedo\": " + closed + "}"})
        EXPECT_FALSE(parse_atmosphere(text, "a.json")) << text.size();
    EXPECT_EQ(load_atmosphere("missing.json").error().kind, ErrorKind::io);
}

TEST(AtmosphereFile, WhatIsNotFiniteIsRefused) {
    for (const double bad : {std::nan(""), HUGE_VAL}) {
        Atmosphere a = earth();
        a.mie->extinction_per_km[1] = bad;
        EXPECT_FALSE(check(a, "a"));
        a = earth();
        a.radius_top_km = bad;
        EXPECT_FALSE(check(a, "a"));
    }
}

}  // namespace
}  // namespace lumo::scene
