// The precomputed sky against double precision: transmittance and order 1 for several planets, and Earth's light by the
// reference's rows in tests/data/atmosphere/earth.csv.
#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include "tests/support/both_apis.hpp"
#include "tests/support/sky.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using atmosphere::Quantity;
using atmosphere::Question;

struct AtmosphereTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, AtmosphereTest, both_apis, api_name);

/// Cameras from the ground to far out, views all around and by the horizon, suns up to 110 degrees and by the horizon.
std::vector<Question> many_views(const scene::Atmosphere& a, Quantity quantity, int count) {
    const reference::AtmosphereOptics optics(a);
    const double top = a.height_km();
    const std::array<double, 10> altitudes{0, 1e-6, 0.002, 0.1, 1, 0.1 * top, 0.3 * top, top, 3 * top, 1e4};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Question> questions;
    for (int i = 0; i < count; ++i) {
        const double h = altitudes[size_t(i) % altitudes.size()];
        const double horizon = std::acos(optics.horizon_mu(h)) * 180 / std::numbers::pi;
        const double u = uniform(random);
        questions.push_back(
            {.altitude_km = h,
             .view_zenith_deg = h > top      ? horizon - u * (i % 4 < 2 ? 0.1 : 10)
                                : i % 3 == 0 ? horizon + 0.5 * (u - 0.5)
                                             : 180 * u,
             .sun_zenith_deg = i % 4 == 0 ? horizon + 2 * (uniform(random) - 0.5) : 110 * uniform(random),
             .azimuth_deg = 180 * uniform(random),
             .distance_km = 200 * std::pow(uniform(random), 3),
             .quantity = quantity});
    }
    return questions;
}

/// What single precision leaves of a ray that comes from afar: its cosine's last place moves it by this part of the
/// altitudes at which it passes.
double from_afar(const Question& q, const scene::Atmosphere& air) {
    return q.altitude_km > air.radius_ground_km ? std::min(2e-3 * q.altitude_km / air.radius_ground_km, 0.02)
                                                : 0;
}

std::map<std::string, scene::Atmosphere> planets() {
    scene::Atmosphere thick = scene::earth();
    for (double& s : thick.rayleigh->scattering_per_km) s *= 5;
    return {{"Earth", scene::earth()}, {"Mars", mars()},           {"60 km", planet_of_60_km()},
            {"thick haze", haze(50)},  {"low haze", haze(1, 0.1)}, {"thick air", thick}};
}

TEST_P(AtmosphereTest, TransmittanceIsExactOnEveryPlanet) {
    for (const auto& [name, air] : planets()) {
        SCOPED_TRACE(name);
        const reference::AtmosphereOptics optics(air);
        std::vector<Question> questions = many_views(air, Quantity::transmittance_to_space, 150);
        for (const Question& q : many_views(air, Quantity::transmittance_segment, 150))
            questions.push_back(q);
        for (const Question& q : many_views(air, Quantity::sun_irradiance, 50)) questions.push_back(q);
        atmosphere::Settings settings = small_sky();
        settings.columns = 256;
        settings.orders = 1;
        const Answers answers = ask(device(), air, settings, questions);
        for (size_t i = 0; i < questions.size(); ++i) {
            const Question& q = questions[i];
            const double mu = reference::cos_degrees(q.view_zenith_deg);
            const bool sun = q.quantity == Quantity::sun_irradiance;
            const scene::Spectrum truth =
                sun ? optics.sun_irradiance(q.altitude_km, reference::cos_degrees(q.sun_zenith_deg))
                : q.quantity == Quantity::transmittance_to_space
                    ? optics.transmittance_to_space({q.altitude_km, mu})
                    : optics.transmittance_segment({q.altitude_km, mu}, q.distance_km);
            for (size_t c = 0; c < truth.size(); ++c)
                EXPECT_NEAR(double(answers[i][c]), truth[c],
                            (1e-3 + from_afar(q, air)) * std::max(truth[c], 1e-5))
                    << where(q);
        }
    }
}

TEST_P(AtmosphereTest, Order1IsExactOnEveryPlanet) {
    for (const auto& [name, air] : planets()) {
        SCOPED_TRACE(name);
        const reference::AtmosphereOptics optics(air);
        std::vector<Question> questions = many_views(air, Quantity::radiance_order1, 120);
        for (const Question& q : many_views(air, Quantity::inscatter, 60)) questions.push_back(q);
        atmosphere::Settings settings = small_sky();
        settings.columns = 256;
        settings.orders = 1;
        const Answers answers = ask(device(), air, settings, questions);
        double greatest = 0;
        std::vector<double> errors;
        for (size_t i = 0; i < questions.size(); ++i) {
            const Question& q = questions[i];
            reference::SkyView view{q.altitude_km, q.view_zenith_deg, q.sun_zenith_deg, q.azimuth_deg};
            if (q.quantity == Quantity::inscatter) view.distance_km = q.distance_km;
            const scene::Spectrum truth = reference::radiance_order1(optics, view, 1e-5);
            const double tolerance = 0.0075 + 2 * from_afar(q, air);
            for (size_t c = 0; c < truth.size(); ++c) {
                const double error = std::abs(double(answers[i][c]) - truth[c]);
                EXPECT_LE(error, tolerance * truth[c] + 1e-8) << where(q) << ": " << truth[c];
                greatest = std::max(greatest, truth[c]);
                if (truth[c] > 1e-8) errors.push_back(error / truth[c]);
            }
        }
        EXPECT_GT(greatest, 1e-3);
        std::ranges::sort(errors);
        EXPECT_LT(errors[errors.size() / 2], 1e-4);
        EXPECT_LT(errors[errors.size() * 95 / 100], 2.5e-3);
    }
}

struct Row {
    Question question;
    std::string quantity, orders;
    std::array<double, 3> truth, noise, floor;
};

std::vector<Row> truth_of_earth() {
    static const std::map<std::string, Quantity> quantities{
        {"transmittance_to_space", Quantity::transmittance_to_space},
        {"transmittance_segment", Quantity::transmittance_segment},
        {"radiance", Quantity::radiance},
        {"radiance_order1", Quantity::radiance_order1},
        {"inscatter", Quantity::inscatter},
        {"sky_irradiance", Quantity::sky_irradiance},
        {"sun_irradiance", Quantity::sun_irradiance}};
    std::ifstream file(LUMO_SOURCE_DIR "/tests/data/atmosphere/earth.csv");
    std::string line;
    std::getline(file, line);
    std::vector<Row> rows;
    while (std::getline(file, line)) {
        std::vector<std::string> cells;
        std::istringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
        cells.resize(16);
        const auto number = [&](size_t i) { return cells[i].empty() ? 0 : std::stod(cells[i]); };
        const auto three = [&](size_t i) { return std::array{number(i), number(i + 1), number(i + 2)}; };
        rows.push_back(
            {.question = {number(0), number(1), number(2), number(3), number(4), quantities.at(cells[5])},
             .quantity = cells[5],
             .orders = cells[6],
             .truth = three(7),
             .noise = three(10),
             .floor = three(13)});
    }
    return rows;
}

/// Bounds of the relative errors of the default preset, beyond three standard errors of the truth.
struct Bound {
    double median, p99, worst;
};

TEST_P(AtmosphereTest, EarthIsAsTheReferenceHasIt) {
    const std::vector<Row> rows = truth_of_earth();
    ASSERT_GT(rows.size(), 1500u);
    std::map<std::string, std::vector<double>> errors;
    for (const bool all : {false, true}) {
        std::vector<Question> questions;
        std::vector<const Row*> asked;
        for (const Row& row : rows) {
            if ((row.orders == "all") != all) continue;
            questions.push_back(row.question);
            asked.push_back(&row);
        }
        atmosphere::Settings settings = settings_of(atmosphere::Preset::standard);
        if (!all) settings.orders = 4;
        const Answers answers = ask(device(), scene::earth(), settings, questions);
        for (size_t i = 0; i < asked.size(); ++i) {
            for (size_t c = 0; c < 3; ++c) {
                const double scale = std::max(asked[i]->truth[c], asked[i]->floor[c]);
                if (scale <= 0) continue;
                const double difference = std::abs(double(answers[i][c]) - asked[i]->truth[c]);
                errors[asked[i]->quantity].push_back(std::max(difference - 3 * asked[i]->noise[c], 0.0) /
                                                     scale);
            }
        }
    }
    for (const auto& [quantity, bound] :
         {std::pair<std::string, Bound>{"transmittance_to_space", {1e-5, 5e-4, 1e-3}},
          {"transmittance_segment", {1e-5, 5e-4, 1e-3}},
          {"radiance_order1", {1e-4, 0.003, 0.005}},
          {"radiance", {0.001, 0.006, 0.025}},
          {"inscatter", {0.001, 0.01, 0.035}},
          {"sky_irradiance", {0.001, 0.01, 0.01}},
          {"sun_irradiance", {1e-4, 1e-3, 1e-3}}}) {
        std::vector<double>& all = errors[quantity];
        ASSERT_GT(all.size(), 200u) << quantity;
        std::ranges::sort(all);
        const double median = all[all.size() / 2], p99 = all[all.size() * 99 / 100], worst = all.back();
        RecordProperty(quantity, fmt::format("{:.5f} {:.5f} {:.5f}", median, p99, worst));
        EXPECT_LE(median, bound.median) << quantity;
        EXPECT_LE(p99, bound.p99) << quantity;
        EXPECT_LE(worst, bound.worst) << quantity;
    }
}

/// Under uniform light of radiance 1 a conservative atmosphere over white ground looks the same in every direction: what
/// a ray that ends in space collects from suns all over the sky is 1 less what it lets through. Vertical depths of 0.4,
/// 0.9 and 2.2, with and without aerosols: the thickest takes 16 orders before the series.
TEST_P(AtmosphereTest, NothingIsCreatedInAFurnace) {
    const scene::Atmosphere air{
        .wavelengths_nm = {550, 500, 450, 400},
        .sun_irradiance = {1, 1, 1, 1},
        .rayleigh = scene::RayleighSpecies{.scattering_per_km = {0.04, 0.08, 0.2, 0.275}},
        .mie = scene::MieSpecies{.scattering_per_km = {0.05, 0.2, 0.5, 0},
                                 .extinction_per_km = {0.05, 0.2, 0.5, 0}},
        .ground_albedo = {1, 1, 1, 1}};
    atmosphere::Settings settings = settings_of(atmosphere::Preset::standard);
    settings.suns = 48;
    settings.zeniths = 18;
    settings.directions = 16;
    settings.degree = 3;
    settings.azimuths = 4;
    const atmosphere::Tables tables = must(atmosphere::Tables::create(device(), air, settings));
    must(atmosphere::precompute(device(), tables));
    constexpr int suns = 60, turns = 16;
    for (const auto& [altitude, zenith] :
         {std::pair{0.0, 20.0}, {0.0, 85.0}, {0.5, 60.0}, {10.0, 40.0}, {30.0, 92.0}}) {
        std::vector<Question> questions;
        for (int k = 0; k < suns; ++k)
            for (int t = 0; t < turns; ++t)
                questions.push_back(
                    {.altitude_km = altitude,
                     .view_zenith_deg = zenith,
                     .sun_zenith_deg = std::acos(1 - 2 * (k + 0.5) / suns) * 180 / std::numbers::pi,
                     .azimuth_deg = 180 * (t + 0.5) / turns});
        questions.push_back({.altitude_km = altitude,
                             .view_zenith_deg = zenith,
                             .quantity = Quantity::transmittance_to_space});
        const Answers answers = ask(device(), tables, questions);
        for (size_t c = 0; c < 4; ++c) {
            double sum = double(answers.back()[c]);
            for (size_t i = 0; i + 1 < answers.size(); ++i)
                sum += 4 * std::numbers::pi / (suns * turns) * double(answers[i][c]);
            RecordProperty(fmt::format("furnace_{}_{}_{}", altitude, zenith, c), fmt::format("{:.5f}", sum));
            EXPECT_NEAR(sum, 1, 0.01) << altitude << " km, " << zenith << ", " << c;
        }
    }
}

TEST_P(AtmosphereTest, IrradianceIsTheIntegralOfRadiance) {
    atmosphere::Settings settings = settings_of(atmosphere::Preset::standard);
    settings.orders = 3;
    const atmosphere::Tables tables = must(atmosphere::Tables::create(device(), scene::earth(), settings));
    must(atmosphere::precompute(device(), tables));
    constexpr int zeniths = 60, azimuths = 60;
    for (const double sun : {20.0, 75.0, 92.0}) {
        std::vector<Question> questions;
        std::vector<double> weights;
        for (int i = 0; i < zeniths; ++i) {
            const double u = (i + 0.5) / zeniths, mu = u * u;
            for (int k = 0; k < azimuths; ++k) {
                questions.push_back({.altitude_km = 1,
                                     .view_zenith_deg = std::acos(mu) * 180 / std::numbers::pi,
                                     .sun_zenith_deg = sun,
                                     .azimuth_deg = 180 * (k + 0.5) / azimuths});
                weights.push_back(mu * 2 * u / zeniths * 2 * std::numbers::pi / azimuths);
            }
        }
        questions.push_back({.altitude_km = 1, .sun_zenith_deg = sun, .quantity = Quantity::sky_irradiance});
        const Answers answers = ask(device(), tables, questions);
        for (size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * double(answers[i][c]);
            EXPECT_NEAR(double(answers.back()[c]) / sum, 1, 0.01) << sun;
        }
    }
}

/// What is not there is 1 and 0, and each wavelength is by itself.
TEST_P(AtmosphereTest, WavelengthsAreIndependent) {
    scene::Atmosphere six = scene::earth();
    const auto repeat = [](scene::Spectrum& values) {
        values.insert(values.end(), values.begin(), values.end());
    };
    for (scene::Spectrum* values :
         {&six.wavelengths_nm, &six.sun_irradiance, &six.ground_albedo, &six.rayleigh->scattering_per_km,
          &six.mie->scattering_per_km, &six.mie->extinction_per_km, &six.ozone->extinction_per_km})
        repeat(*values);
    const std::vector<scene::Atmosphere> parts = atmosphere::by_fours(six);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].wavelengths_nm.size(), 4u);
    EXPECT_EQ(parts[1].wavelengths_nm, (scene::Spectrum{550, 440}));
    const std::vector<Question> questions = many_views(scene::earth(), Quantity::radiance, 40);
    const Answers first = ask(device(), parts[0], small_sky(), questions);
    const Answers second = ask(device(), parts[1], small_sky(), questions);
    for (size_t i = 0; i < questions.size(); ++i) {
        EXPECT_EQ(first[i][0], first[i][3]);
        EXPECT_EQ(first[i][1], second[i][0]);
        EXPECT_EQ(first[i][2], second[i][1]);
        EXPECT_EQ(second[i][2], 0);
    }
}

TEST_P(AtmosphereTest, SettingsOutOfRangeAreRefused) {
    for (const atmosphere::Settings& bad : {atmosphere::Settings{.orders = 0},
                                            {.iterations = 1},
                                            {.suns = 1},
                                            {.degree = 16},
                                            {.azimuths = 4},
                                            {.directions = 128},
                                            {.nodes = 17}}) {
        const auto made = atmosphere::Tables::create(device(), scene::earth(), bad);
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error().kind, ErrorKind::invalid_argument);
        EXPECT_FALSE(made.error().remedy.empty());
    }
    EXPECT_FALSE(atmosphere::parse_preset("best"));
}

struct AtmosphereParity : BothApisTest {};

TEST_F(AtmosphereParity, BothApisGiveTheSameSky) {
    atmosphere::Settings settings = small_sky();
    for (const Quantity quantity : {Quantity::radiance, Quantity::inscatter, Quantity::sky_irradiance,
                                    Quantity::transmittance_to_space, Quantity::sun_irradiance}) {
        const std::vector<Question> questions = many_views(scene::earth(), quantity, 300);
        const Answers a = ask(gl(), scene::earth(), settings, questions);
        const Answers b = ask(vulkan(), scene::earth(), settings, questions);
        double mean = 0;
        for (const auto& answer : a) mean += double(answer[1]) / double(a.size());
        for (size_t i = 0; i < a.size(); ++i)
            for (size_t c = 0; c < 3; ++c)
                EXPECT_LE(std::abs(double(a[i][c]) - double(b[i][c])),
                          1e-4 * std::max({double(a[i][c]), double(b[i][c]), mean}))
                    << where(questions[i]);
    }
}

}  // namespace
}  // namespace lumo
