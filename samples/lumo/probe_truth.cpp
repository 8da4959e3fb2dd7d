#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "rhi/disk_cache.hpp"
#include "samples/lumo/probe_sky.hpp"

namespace lumo::program {
namespace {

using atmosphere::Quantity;
using atmosphere::Question;
using reference::AtmosphereOptics;
using reference::Estimate;
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

SkyAnswer truth_of(const AtmosphereOptics& optics, const Question& question,
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
            return sample_until(
                settings, seed_of(question), Spectrum(optics.wavelengths(), 0), 1,
                [&](const PathSettings& paths) { return reference::sky_irradiance(optics, view, paths); });
        case Quantity::radiance_order1:
            break;
        case Quantity::radiance:
        case Quantity::inscatter:
            if (settings.last_order == 1) break;
            return sample_until(
                settings, seed_of(question), reference::radiance_order1(optics, view), 2,
                [&](const PathSettings& paths) { return reference::radiance(optics, view, paths); });
    }
    return {.value = reference::radiance_order1(optics, view)};
}

}  // namespace

std::vector<SkyAnswer> sky_truth(const AtmosphereOptics& optics, std::span<const Question> questions,
                                 const SkyTruthSettings& settings,
                                 const std::function<void(size_t)>& answered) {
    std::vector<SkyAnswer> answers(questions.size());
    std::atomic<size_t> next = 0, done = 0;
    const auto work = [&](bool tells) {
        for (size_t i = next++; i < questions.size(); i = next++) {
            answers[i] = truth_of(optics, questions[i], settings);
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
