#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "rhi/disk_cache.hpp"
#include "samples/lumo/probe_sky.hpp"

namespace lumo::program {
namespace {

using reference::AtmosphereOptics;
using reference::Estimate;
using reference::PathSettings;
using reference::RayPoint;
using reference::SkyView;
using scene::Spectrum;

/// Of the query alone, so that a row's answer is the same in any table, and its error that row's own.
uint64_t seed_of(const SkyQuery& query) {
    const SkyView& v = query.view;
    rhi::KeyBuilder key;
    key.add(uint64_t(query.quantity));
    for (const double number :
         {v.altitude_km, v.view_zenith_deg, v.sun_zenith_deg, v.azimuth_deg, v.distance_km})
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

SkyAnswer truth_of(const AtmosphereOptics& optics, const SkyQuery& query, const SkyTruthSettings& settings) {
    const SkyView& view = query.view;
    const RayPoint from{.h = view.altitude_km, .mu = reference::cos_degrees(view.view_zenith_deg)};
    switch (query.quantity) {
        case SkyQuantity::transmittance_to_space:
            return {.value = optics.transmittance_to_space(from)};
        case SkyQuantity::transmittance_segment:
            return {.value = optics.transmittance_segment(from, view.distance_km)};
        case SkyQuantity::sun_irradiance:
            return {.value = optics.sun_irradiance(from.h, reference::cos_degrees(view.sun_zenith_deg))};
        case SkyQuantity::sky_irradiance:
            return sample_until(
                settings, seed_of(query), Spectrum(optics.wavelengths(), 0), 1,
                [&](const PathSettings& paths) { return reference::sky_irradiance(optics, view, paths); });
        case SkyQuantity::radiance_order1:
            break;
        case SkyQuantity::radiance:
        case SkyQuantity::inscatter:
            if (settings.last_order == 1) break;
            return sample_until(
                settings, seed_of(query), reference::radiance_order1(optics, view), 2,
                [&](const PathSettings& paths) { return reference::radiance(optics, view, paths); });
    }
    return {.value = reference::radiance_order1(optics, view)};
}

}  // namespace

std::vector<SkyAnswer> sky_truth(const AtmosphereOptics& optics, std::span<const SkyQuery> queries,
                                 const SkyTruthSettings& settings,
                                 const std::function<void(size_t)>& answered) {
    std::vector<SkyAnswer> answers(queries.size());
    std::atomic<size_t> next = 0, done = 0;
    const auto work = [&](bool tells) {
        for (size_t i = next++; i < queries.size(); i = next++) {
            answers[i] = truth_of(optics, queries[i], settings);
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
