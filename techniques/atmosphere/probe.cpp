#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "techniques/atmosphere/atmosphere.hpp"

namespace lumo::atmosphere {
namespace {

constexpr uint32_t questions_per_step = 4096;

/// Exact at multiples of 90 degrees.
double cos_degrees(double degrees) { return std::sin((90 - std::abs(degrees)) * (std::numbers::pi / 180)); }

/// As shaders/atmosphere/probe.comp has it.
struct Asked {
    float altitude, mu, mu_sun, nu, distance;
    uint32_t quantity, padding[2];
};

Asked asked(const Question& q) {
    const double mu = cos_degrees(q.view_zenith_deg), mu_sun = cos_degrees(q.sun_zenith_deg);
    const double sines = cos_degrees(90 - q.view_zenith_deg) * cos_degrees(90 - q.sun_zenith_deg);
    return {.altitude = float(q.altitude_km),
            .mu = float(mu),
            .mu_sun = float(mu_sun),
            .nu = float(std::clamp(sines * cos_degrees(q.azimuth_deg) + mu * mu_sun, -1.0, 1.0)),
            .distance = float(q.distance_km),
            .quantity = uint32_t(q.quantity),
            .padding = {}};
}

}  // namespace

Result<Probe> Probe::create(rhi::Device& device) {
    Probe made;
    return device.create_compute_pipeline<shaders::atmosphere::probe>().map([&](auto pipeline) {
        made.pipeline_ = std::move(pipeline);
        return std::move(made);
    });
}

Result<std::vector<std::array<float, max_wavelengths>>> Probe::ask(
    rhi::Device& device, const Tables& tables, std::span<const Question> questions) const {
    std::vector<std::array<float, max_wavelengths>> answers(questions.size());
    if (questions.empty()) return answers;
    std::vector<Asked> input(questions.size());
    std::ranges::transform(questions, input.begin(), asked);
    auto in = device.create_buffer({.name = "atmosphere.questions", .size = input.size() * sizeof(Asked)});
    if (!in) return tl::unexpected(in.error());
    auto out = device.create_buffer(
        {.name = "atmosphere.answers", .size = std::as_bytes(std::span(answers)).size()});
    if (!out) return tl::unexpected(out.error());
    if (auto up = device.upload(in->slice(), std::as_bytes(std::span(input))); !up)
        return tl::unexpected(up.error());

    for (uint32_t first = 0; first < questions.size(); first += questions_per_step) {
        const uint32_t count = std::min(questions_per_step, uint32_t(questions.size()) - first);
        rhi::Commands commands = device.begin();
        const Sky sky = tables.sky(commands);
        commands.pass("atmosphere.probe")
            .dispatch(pipeline_,
                      {.air = sky.block,
                       .air_columns = sky.columns,
                       .air_light = sky.light,
                       .air_peaks = sky.peaks,
                       .questions = in->slice(),
                       .answers = out->slice()},
                      {.first = first, .count = count}, {rhi::groups_for(count, 64)});
        if (auto done = device.wait(device.submit(std::move(commands))); !done)
            return tl::unexpected(done.error());
    }
    return device.download(out->slice()).map([&](const std::vector<std::byte>& bytes) {
        std::memcpy(answers.data(), bytes.data(), bytes.size());
        return std::move(answers);
    });
}

}  // namespace lumo::atmosphere
