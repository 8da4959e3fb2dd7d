// The precomputed sky where atmospheres are extreme, and cameras and suns are on an edge.
#include <fmt/format.h>
#include <map>
#include <numbers>

#include "tests/support/sky.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using atmosphere::Quantity;
using atmosphere::Question;

struct AtmosphereExtremes : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, AtmosphereExtremes, both_apis, api_name);

double degrees(double cosine) { return std::acos(cosine) * 180 / std::numbers::pi; }

std::map<std::string, scene::Atmosphere> extremes() {
    scene::Atmosphere thick = scene::earth(), empty = scene::earth(), molecules = scene::earth();
    scene::Atmosphere aerosols = scene::earth(), ozone = scene::earth(), black = scene::earth();
    for (double& s : thick.rayleigh->scattering_per_km) s *= 5;
    empty.rayleigh.reset(), empty.mie.reset(), empty.ozone.reset();
    molecules.mie.reset(), molecules.ozone.reset();
    aerosols.rayleigh.reset(), aerosols.ozone.reset();
    ozone.rayleigh.reset(), ozone.mie.reset();
    black.ground_albedo = {0, 0.5, 1};
    scene::Atmosphere backward = scene::earth(), narrow = scene::earth(), low = scene::earth();
    backward.mie->g = -0.9;
    narrow.mie->g = 0.999;
    narrow.sun_angular_radius_deg = 0;
    low.radius_top_km = low.radius_ground_km + 0.1;
    return {{"haze", haze(50)},       {"low haze", haze(1, 0.1)},   {"thick", thick},
            {"mars", mars()},         {"60 km", planet_of_60_km()}, {"empty", empty},
            {"molecules", molecules}, {"aerosols", aerosols},       {"ozone", ozone},
            {"albedo 0 to 1", black}, {"backward", backward},       {"narrow", narrow},
            {"air of 100 m", low}};
}

TEST_P(AtmosphereExtremes, EverythingIsFiniteAndNotNegative) {
    for (const auto& [name, air] : extremes()) {
        SCOPED_TRACE(name);
        const reference::AtmosphereOptics optics(air);
        std::vector<Question> questions;
        for (const double h : {0.0, 1e-6, 1.0, air.height_km(), 1e4}) {
            const double horizon = degrees(optics.horizon_mu(h));
            for (const double zenith : {0.0, 90.0, horizon - 1e-5, horizon, horizon + 1e-5, 180.0})
                for (const double sun : {0.0, 45.0, 90.0, horizon, 108.0, 180.0})
                    for (const double azimuth : {0.0, 180.0})
                        for (uint32_t quantity = 0; quantity < 7; ++quantity)
                            questions.push_back({h, zenith, sun, azimuth, 10, Quantity(quantity)});
        }
        const Answers answers = ask(device(), air, small_sky(), questions);
        for (size_t i = 0; i < questions.size(); ++i)
            for (const float value : answers[i])
                EXPECT_TRUE(std::isfinite(value) && value >= 0)
                    << where(questions[i]) << ", quantity " << uint32_t(questions[i].quantity) << ": "
                    << value;
        if (!air.rayleigh && !air.mie) {
            for (size_t i = 0; i < questions.size(); ++i) {
                if (questions[i].quantity == Quantity::radiance) {
                    EXPECT_EQ(answers[i][0], 0);
                }
            }
        }
    }
}

/// Through the horizon, in steps of a thousandth of a degree: order 1 is the reference's on both sides, whose own step at
/// the horizon is the air behind it, and light of all orders is smooth on each side.
TEST_P(AtmosphereExtremes, NoSeamAtTheHorizon) {
    const scene::Atmosphere air = scene::earth();
    const reference::AtmosphereOptics optics(air);
    const atmosphere::Tables tables = must(atmosphere::Tables::create(device(), air, small_sky()));
    must(atmosphere::precompute(device(), tables));
    constexpr int steps = 100;
    for (const double h : {1e-6, 0.002, 1.0, 10.0, 60.0, 400.0}) {
        for (const double sun : {40.0, 89.0}) {
            const double horizon = degrees(optics.horizon_mu(h));
            std::vector<Question> first, all;
            for (int i = -steps; i <= steps; ++i) {
                if (i == 0) continue;
                all.push_back({h, horizon + 1e-3 * i, sun, 30, 0, Quantity::radiance});
                first.push_back(all.back());
                first.back().quantity = Quantity::radiance_order1;
            }
            const Answers order1 = ask(device(), tables, first), light = ask(device(), tables, all);
            for (size_t i = 0; i < all.size(); i += 11) {
                const Question& q = first[i];
                const auto truth = reference::radiance_order1(
                    optics, {h, q.view_zenith_deg, q.sun_zenith_deg, q.azimuth_deg}, 1e-5);
                for (size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(double(order1[i][c]), truth[c], 0.01 * truth[c] + 1e-6) << where(q);
            }
            // Second differences, away from the step itself. Below the horizon a low camera sees no farther than the
            // ground, which the angle decides.
            for (size_t i = 1; i + 1 < all.size(); ++i) {
                const size_t from_step = i < steps ? steps - 1 - i : i - steps;
                if (from_step < 2 || (i >= steps && h < 1)) continue;
                for (size_t c = 0; c < 3; ++c) {
                    const double bend =
                        double(light[i - 1][c]) + double(light[i + 1][c]) - 2 * double(light[i][c]);
                    EXPECT_LE(std::abs(bend), 0.01 * double(light[i][c])) << where(all[i]);
                }
            }
        }
    }
}

/// From the ground to where little air is left, by steps of a centimetre at first and of a per cent later.
TEST_P(AtmosphereExtremes, NoStepAsTheCameraClimbs) {
    const scene::Atmosphere air = scene::earth();
    const atmosphere::Tables tables = must(atmosphere::Tables::create(device(), air, small_sky()));
    must(atmosphere::precompute(device(), tables));
    for (const double zenith : {0.0, 60.0, 85.0}) {
        for (const double sun : {30.0, 88.0, 93.0}) {
            for (const Quantity quantity : {Quantity::radiance, Quantity::sky_irradiance}) {
                std::vector<Question> questions;
                for (double h = 0; h < 50; h = h * 1.01 + 1e-5)
                    questions.push_back({h, zenith, sun, 60, 0, quantity});
                const Answers answers = ask(device(), tables, questions);
                for (size_t i = 1; i < answers.size(); ++i) {
                    if (questions[i].altitude_km > 58)
                        break;  // the air, and all light from above, ends there
                    for (size_t c = 0; c < 3; ++c)
                        EXPECT_LE(std::abs(double(answers[i][c]) - double(answers[i - 1][c])),
                                  0.15 * double(answers[i - 1][c]) + 1e-7)
                            << where(questions[i]);
                }
            }
        }
    }
}

}  // namespace
}  // namespace lumo
