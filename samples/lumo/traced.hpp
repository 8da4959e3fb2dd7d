// Pictures by the path tracer, in place of a GPU.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "samples/lumo/options.hpp"
#include "samples/lumo/pictures.hpp"
#include "samples/lumo/progress.hpp"

namespace lumo::program {

/// That the path tracer has what the options ask for, into a file of that extension. Errors: invalid_argument.
Result<void> check_traceable(const Options& options, std::string_view extension);

struct TracedPicture {
    Picture picture = {};
    nlohmann::ordered_json stats = {};  ///< settings, wall_ms and, of each layer of light, its relative noise
};

/// The steps that it takes on the bar.
inline constexpr int trace_steps = 100;

/// The layers of Options::frame by those names, without antialiasing as frames have them. Errors: those of
/// reference::path_trace.
Result<TracedPicture> trace(const Options& options, const std::vector<std::string>& layer_names,
                            const scene::Scene& scene, const scene::Camera& camera, Progress& progress);

}  // namespace lumo::program
