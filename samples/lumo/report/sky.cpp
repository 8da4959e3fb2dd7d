#include "samples/lumo/report/sky.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace lumo::program {
namespace {

using atmosphere::Quantity;
using atmosphere::Question;
using Json = nlohmann::ordered_json;

constexpr double floor_part = 1e-3;

double milliseconds_of(auto&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// Of the rows with this quantity.
SkyError error_of(std::span<const Question> questions, std::span<const SkyAnswer> truth,
                  std::span<const SkyAnswer> answers, Quantity quantity) {
    std::vector<double> errors;
    double noise = 0;
    for (size_t i = 0; i < questions.size(); ++i) {
        if (questions[i].quantity != quantity) continue;
        double error = 0;
        for (size_t w = 0; w < truth[i].value.size(); ++w) {
            double scale = truth[i].value[w];
            for (size_t k = 0; k < questions.size(); ++k)
                if (questions[k].quantity == quantity &&
                    questions[k].sun_zenith_deg == questions[i].sun_zenith_deg)
                    scale = std::max(scale, floor_part * truth[k].value[w]);
            if (scale <= 0) continue;
            error = std::max(error, std::abs(answers[i].value[w] - truth[i].value[w]) / scale);
            if (!truth[i].error.empty()) noise = std::max(noise, truth[i].error[w] / scale);
        }
        errors.push_back(error);
    }
    if (errors.empty()) return {};
    std::ranges::sort(errors);
    return {.median = errors[errors.size() / 2], .worst = errors.back(), .noise = noise};
}

Json to_json(const SkyError& error) {
    return {{"median", error.median}, {"worst", error.worst}, {"noise", error.noise}};
}

SkyError sky_error_of(const Json& json) {
    return {.median = json.at("median"), .worst = json.at("worst"), .noise = json.at("noise")};
}

/// All directions, from where the scene is.
std::vector<Question> panorama(const scene::Sky& sky, double sun_zenith_deg) {
    constexpr uint32_t width = 160, height = 90;
    std::vector<Question> pixels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            pixels.push_back({.altitude_km = sky.altitude_km,
                              .view_zenith_deg = 180 * (y + 0.5) / height,
                              .sun_zenith_deg = sun_zenith_deg,
                              .azimuth_deg = 360 * (x + 0.5) / width,
                              .quantity = Quantity::radiance});
    return pixels;
}

}  // namespace

Json to_json(const SkyFigures& figures) {
    return {{"preset", figures.preset},
            {"precomputation_ms", figures.precomputation_ms},
            {"bytes", figures.bytes},
            {"ns_per_pixel", figures.ns_per_pixel},
            {"order1", to_json(figures.order1)},
            {"radiance", to_json(figures.radiance)},
            {"irradiance", to_json(figures.irradiance)}};
}

std::optional<SkyFigures> sky_figures_of(const Json& json) {
    try {
        return SkyFigures{.preset = json.at("preset"),
                          .precomputation_ms = json.at("precomputation_ms"),
                          .bytes = json.at("bytes"),
                          .ns_per_pixel = json.at("ns_per_pixel"),
                          .order1 = sky_error_of(json.at("order1")),
                          .radiance = sky_error_of(json.at("radiance")),
                          .irradiance = sky_error_of(json.at("irradiance"))};
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

std::vector<Question> sky_questions(const scene::Sky& sky) {
    const double own =
        std::acos(std::clamp(double(sky.direction_to_sun.y), -1.0, 1.0)) * 180 / std::numbers::pi;
    std::vector<Question> questions;
    for (const double sun : {own, 30.0, 75.0, 88.0}) {
        Question question{.altitude_km = sky.altitude_km, .sun_zenith_deg = sun};
        for (const auto& [zenith, azimuth] :
             {std::pair{15.0, 60.0}, {55.0, 170.0}, {75.0, 20.0}, {87.0, 110.0}}) {
            question.view_zenith_deg = zenith;
            question.azimuth_deg = azimuth;
            for (const Quantity quantity : {Quantity::radiance_order1, Quantity::radiance}) {
                question.quantity = quantity;
                questions.push_back(question);
            }
        }
        question.quantity = Quantity::sky_irradiance;
        questions.push_back(question);
    }
    return questions;
}

std::vector<SkyAnswer> sky_truth_of(const scene::Sky& sky, std::span<const Question> questions) {
    const SkyTruthSettings settings{.samples = 16'384, .relative_error = 0.005};
    return sky_truth(reference::AtmosphereOptics(sky.atmosphere), questions, settings, [](size_t) {});
}

Result<SkyFigures> measure_sky(rhi::Device& device, const scene::Sky& sky, const std::string& preset,
                               std::span<const Question> questions, std::span<const SkyAnswer> truth) {
    const auto chosen = atmosphere::parse_preset(preset);
    if (!chosen) return tl::unexpected(chosen.error());
    const auto probe = atmosphere::Probe::create(device);
    if (!probe) return tl::unexpected(probe.error());
    SkyFigures figures{.preset = preset};
    const std::vector<Question> pixels = panorama(sky, questions.front().sun_zenith_deg);
    std::vector<SkyAnswer> answers(questions.size());
    for (const scene::Atmosphere& four : atmosphere::by_fours(sky.atmosphere)) {
        Result<atmosphere::Tables> tables;
        figures.precomputation_ms += milliseconds_of([&] {
            tables = atmosphere::Tables::create(device, four, settings_of(*chosen));
            if (!tables) return;
            if (const auto done = atmosphere::precompute(device, *tables); !done)
                tables = tl::unexpected(done.error());
        });
        if (!tables) return tl::unexpected(tables.error());
        figures.bytes += tables->bytes();
        // The first use of a program compiles it.
        const auto found = probe->ask(device, *tables, questions);
        if (!found) return tl::unexpected(found.error());
        Result<void> drawn;
        const double milliseconds = milliseconds_of([&] {
            if (const auto sky_seen = probe->ask(device, *tables, pixels); !sky_seen)
                drawn = tl::unexpected(sky_seen.error());
        });
        if (!drawn) return tl::unexpected(drawn.error());
        figures.ns_per_pixel += 1e6 * milliseconds / double(pixels.size());
        for (size_t i = 0; i < answers.size(); ++i)
            for (size_t w = 0; w < four.wavelengths_nm.size(); ++w)
                answers[i].value.push_back(double((*found)[i][w]));
    }
    figures.order1 = error_of(questions, truth, answers, Quantity::radiance_order1);
    figures.radiance = error_of(questions, truth, answers, Quantity::radiance);
    figures.irradiance = error_of(questions, truth, answers, Quantity::sky_irradiance);
    return figures;
}

}  // namespace lumo::program
