// What a report says about the sky's tables: how far they are from the truth, against what they cost.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "samples/lumo/probe_sky.hpp"
#include "scene/scene.hpp"

namespace lumo::program {

/// Parts of the greater of the truth and a thousandth of the brightest under the same sun, of the worst wavelength.
struct SkyError {
    double median = 0;
    double worst = 0;
    double noise = 0;  ///< the worst standard error that the truth itself has
};

/// A preset of the sky's tables on one device.
struct SkyFigures {
    std::string preset = {};
    double precomputation_ms = 0;  ///< wall time, nothing taken from a cache
    uint64_t bytes = 0;
    double ns_per_pixel = 0;   ///< wall time of a panorama from where the scene is
    SkyError order1 = {};      ///< radiance of order 1, whose truth is exact
    SkyError radiance = {};    ///< of all orders
    SkyError irradiance = {};  ///< of the sky on a level plane
};

nlohmann::ordered_json to_json(const SkyFigures& figures);
/// Nothing if it is not what to_json makes.
std::optional<SkyFigures> sky_figures_of(const nlohmann::ordered_json& json);

/// What errors are measured with: views from the scene's origin under its own sun and three others.
std::vector<atmosphere::Question> sky_questions(const scene::Sky& sky);

/// The reference's answers to them, whose standard errors are at most half a per cent or what some ten thousand paths
/// leave.
std::vector<SkyAnswer> sky_truth_of(const scene::Sky& sky, std::span<const atmosphere::Question> questions);

/// Errors: those of the device and of Tables::create.
Result<SkyFigures> measure_sky(rhi::Device& device, const scene::Sky& sky, const std::string& preset,
                               std::span<const atmosphere::Question> questions,
                               std::span<const SkyAnswer> truth);

}  // namespace lumo::program
