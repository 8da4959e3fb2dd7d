// Spectra as colours, and what a scene with a sky is lit by.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "scene/sky.hpp"

namespace lumo::scene {
namespace {

/// Rec. 709's weights of luminance, to the places that its primaries have.
double luminance(glm::dvec3 rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

double black_body(double nm, double kelvin) {
    return std::pow(nm / 1000, -5) / std::expm1(14387768.775 / (nm * kelvin));
}

Spectrum every(double from, double to, double step) {
    Spectrum wavelengths;
    for (double nm = from; nm <= to; nm += step) wavelengths.push_back(nm);
    return wavelengths;
}

template <class F>
glm::dvec3 color_of(const Spectrum& wavelengths, const F& spectrum) {
    Spectrum values;
    for (const double nm : wavelengths) values.push_back(spectrum(nm));
    glm::dvec3 sum(0);
    const auto weights = rgb_weights(wavelengths);
    for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values[i];
    return sum;
}

TEST(SpectralColor, LuminanceIsThePhotometricOneOver683) {
    // The observer's second function integrates to 106.86 nm; equal energy is white by definition of XYZ, slightly red of
    // D65.
    const glm::dvec3 equal = color_of(every(380, 780, 5), [](double) { return 1.0; });
    EXPECT_NEAR(luminance(equal), 106.86, 0.3);
    EXPECT_NEAR(equal.r / equal.g, 1.2048 / 0.9484, 0.02);
    EXPECT_NEAR(equal.b / equal.g, 0.9087 / 0.9484, 0.02);
}

TEST(SpectralColor, TheSunIsNearlyWhite) {
    // As extraterrestrial illuminance: 133 klx by the table of ASTM E-490.
    const Atmosphere air = earth();
    const glm::dvec3 sun = to_rgb(rgb_weights(air.wavelengths_nm), air.sun_irradiance);
    EXPECT_NEAR(luminance(sun) * 683, 133e3, 0.04 * 133e3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun[c] / luminance(sun), 1, 0.12) << c;
    RecordProperty("sun", fmt::format("{:.1f} {:.1f} {:.1f}", sun.r, sun.g, sun.b));
}

/// Sunlight that molecules scatter or let through, by Earth's three wavelengths against many.
TEST(SpectralColor, ThreeWavelengthsAreEnoughForSkies) {
    const Spectrum few = earth().wavelengths_nm, many = every(362, 828, 2);
    double of_day = 0, of_sunset = 0;
    for (const double scattered : {0.0, 1.0, 2.0, 3.0, 4.0}) {
        for (const double depth : {0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.5}) {
            double& worst = depth < 0.3 ? of_day : of_sunset;
            const auto light = [&](double nm) {
                return black_body(nm, 5772) * std::pow(nm / 550, -scattered) *
                       std::exp(-depth * std::pow(nm / 550, -4));
            };
            const glm::dvec3 exact = color_of(many, light), approximate = color_of(few, light);
            const glm::dvec3 error = (approximate - exact) / std::max({exact.r, exact.g, exact.b});
            for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(error[c]));
        }
    }
    // Of the brightest channel.
    RecordProperty("worst_of_day_and_of_sunset", fmt::format("{:.4f}, {:.4f}", of_day, of_sunset));
    EXPECT_LT(of_day, 0.05);
    EXPECT_LT(of_sunset, 0.09);
}

TEST(SpectralColor, OrderAndNumberOfWavelengthsDoNotMatter) {
    const auto light = [](double nm) { return black_body(nm, 5772) * (1 + nm / 1000); };
    const glm::dvec3 sorted = color_of({440, 550, 680}, light), reversed = color_of({680, 550, 440}, light);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sorted[c], reversed[c], 1e-12 * sorted.g);
    // One wavelength tells how bright it is, and has the sun's colour.
    const glm::dvec3 one = color_of({550}, [](double nm) { return black_body(nm, 5772); });
    const glm::dvec3 all = color_of(every(360, 830, 1), [](double nm) { return black_body(nm, 5772); });
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], all[c], 1e-9 * all.g);
}

TEST(SetSky, TakesThePlaceOfAllThatShoneFromFarAway) {
    Scene scene;
    scene.environment_radiance = glm::vec3(1);
    scene.lights = {{.name = "old sun", .intensity = glm::vec3(5)},
                    {.name = "lamp", .kind = LightKind::point, .intensity = glm::vec3(2)}};
    set_sky(scene, {.direction_to_sun = glm::normalize(glm::vec3(1, 2, 0))});
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].name, "sun");
    EXPECT_EQ(scene.lights[1].name, "lamp");
    EXPECT_EQ(scene.environment_radiance, glm::vec3(0));
    EXPECT_EQ(scene.lights[0].direction, -glm::normalize(glm::vec3(1, 2, 0)));

    // Lower suns are dimmer and redder, and below the horizon there is none.
    glm::vec3 before = scene.lights[0].intensity;
    for (const float degrees : {20.0f, 10.0f, 5.0f, 2.0f, 0.0f}) {
        const float angle = glm::radians(degrees);
        set_sky(scene, {.direction_to_sun = {std::cos(angle), std::sin(angle), 0}});
        const glm::vec3 sun = scene.lights[0].intensity;
        EXPECT_LT(sun.g, before.g) << degrees;
        EXPECT_LT(sun.b / sun.r, before.b / before.r) << degrees;
        before = sun;
    }
    for (const float degrees : {-0.3f, -5.0f, -90.0f}) {
        const float angle = glm::radians(degrees);
        set_sky(scene, {.direction_to_sun = {std::cos(angle), std::sin(angle), 0}});
        EXPECT_EQ(scene.lights[0].intensity, glm::vec3(0)) << degrees;
    }
    // From high up it is above the horizon still.
    const float angle = glm::radians(-2.0f);
    set_sky(scene, {.direction_to_sun = {std::cos(angle), std::sin(angle), 0}, .altitude_km = 10});
    EXPECT_GT(scene.lights[0].intensity.r, 0);
}

}  // namespace
}  // namespace lumo::scene
