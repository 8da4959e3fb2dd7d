#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>
#include <thread>

#include "reference/atmosphere_paths.hpp"
#include "rhi/disk_cache.hpp"
#include "samples/lumo/probe_sky.hpp"

namespace lumo::program {
namespace {

using atmosphere::Quantity;
using atmosphere::Question;
using reference::AtmosphereOptics;
using reference::Estimate;
using reference::GuidedPaths;
using reference::PathSettings;
using reference::RayPoint;
using reference::SkyView;
using scene::Spectrum;

/// Of the question alone, so that a row's answer is the same in any table, and its error that row's own.
uint64_t seed_of(const Question& question) {
    rhi::KeyBuilder key;
    key.add(uint64_t(question.quantity));
    for (const double number : {question.altitude_km, question.view_zenith_deg, question.sun_zenith_deg,
                                question.azimuth_deg, question.distance_km})
        key.add(std::bit_cast<uint64_t>(number));
    return key.key().high;
}

/// Twice as many paths each time, until they are as good or as many as the settings say. `known` is added.
SkyAnswer sample_until(const SkyTruthSettings& settings, uint64_t seed, Spectrum known, uint32_t first_order,
                       const std::function<Estimate(const PathSettings&)>& sample) {
    constexpr uint32_t fewest = 4096;
    const size_t size = known.size();
    Spectrum sums(size, 0), squares(size, 0);  // of what batches found, weighted by their sizes
    SkyAnswer answer{.value = known, .error = Spectrum(size, 0)};
    for (uint32_t done = 0, batch = fewest; done < settings.samples; batch = done) {
        batch = std::min(batch, settings.samples - done);
        const Estimate found = sample({.first_order = first_order,
                                       .last_order = settings.last_order,
                                       .samples = batch,
                                       .seed = seed + done});
        done += batch;
        bool enough = true;
        for (size_t i = 0; i < size; ++i) {
            sums[i] += batch * found.mean[i];
            squares[i] += std::pow(batch * found.error[i], 2);
            answer.value[i] = known[i] + sums[i] / done;
            answer.error[i] = std::sqrt(squares[i]) / done;
            enough &= answer.error[i] <= settings.relative_error * answer.value[i];
        }
        if (enough) break;
    }
    return answer;
}

bool is_sampled(const Question& question, const SkyTruthSettings& settings) {
    const bool scattered =
        question.quantity == Quantity::radiance || question.quantity == Quantity::inscatter;
    return question.quantity == Quantity::sky_irradiance || (scattered && settings.last_order > 1);
}

/// `paths` are there if the answer is sampled.
SkyAnswer truth_of(const AtmosphereOptics& optics, const GuidedPaths* paths, const Question& question,
                   const SkyTruthSettings& settings) {
    SkyView view{.altitude_km = question.altitude_km,
                 .view_zenith_deg = question.view_zenith_deg,
                 .sun_zenith_deg = question.sun_zenith_deg,
                 .azimuth_deg = question.azimuth_deg};
    if (question.quantity == Quantity::inscatter) view.distance_km = question.distance_km;
    const RayPoint from{.h = view.altitude_km, .mu = reference::cos_degrees(view.view_zenith_deg)};
    switch (question.quantity) {
        case Quantity::transmittance_to_space:
            return {.value = optics.transmittance_to_space(from)};
        case Quantity::transmittance_segment:
            return {.value = optics.transmittance_segment(from, question.distance_km)};
        case Quantity::sun_irradiance:
            return {.value = optics.sun_irradiance(from.h, reference::cos_degrees(view.sun_zenith_deg))};
        case Quantity::sky_irradiance:
        case Quantity::radiance_order1:
        case Quantity::radiance:
        case Quantity::inscatter:
            break;
    }
    if (question.quantity == Quantity::sky_irradiance)
        return sample_until(settings, seed_of(question), Spectrum(optics.wavelengths(), 0), 1,
                            [&](const PathSettings& some) { return paths->sky_irradiance(view, some); });
    Spectrum order1 = reference::radiance_order1(optics, view);
    if (!is_sampled(question, settings)) return {.value = std::move(order1)};
    return sample_until(settings, seed_of(question), std::move(order1), 2,
                        [&](const PathSettings& some) { return paths->radiance(view, some); });
}

}  // namespace

std::vector<SkyAnswer> sky_truth(const AtmosphereOptics& optics, std::span<const Question> questions,
                                 const SkyTruthSettings& settings,
                                 const std::function<void(size_t)>& answered) {
    std::vector<SkyAnswer> answers(questions.size());
    std::optional<GuidedPaths> paths;
    if (std::ranges::any_of(questions, [&](const Question& q) { return is_sampled(q, settings); }))
        paths.emplace(optics);
    std::atomic<size_t> next = 0, done = 0;
    const auto work = [&](bool tells) {
        for (size_t i = next++; i < questions.size(); i = next++) {
            answers[i] = truth_of(optics, paths ? &*paths : nullptr, questions[i], settings);
            ++done;
            if (tells) answered(done);
        }
    };
    std::vector<std::jthread> others;
    for (uint32_t i = 1; i < std::max(std::thread::hardware_concurrency(), 1u); ++i)
        others.emplace_back(work, false);
    work(true);
    return answers;
}

}  // namespace lumo::program
