// What a report measures: combinations of settings.
#pragma once

#include <string>
#include <vector>

#include "samples/lumo/options.hpp"

namespace lumo::program {

struct Configuration {
    Options options;
    std::vector<SettingValue> varied =
        {};                  ///< every setting that differs somewhere in the report, and its value here
    std::string label = {};  ///< the same in a few letters a setting, as in plots
    bool standard = false;   ///< what the options say without --vary and --also
};

/// Every combination of Options::vary, those of Options::also, and the standard one; each once. What a report varies if
/// the options say nothing: voxels, cones, mips and rotate-cones. Errors: invalid_argument, with what there is; limit
/// (more than 10 000).
Result<std::vector<Configuration>> configurations_of(const Options& options);

/// The configuration of the same voxels whose irradiance is gathered by many rays through them: the floor of its error.
/// What it shares with others it is the same for, so that it need not be measured for each.
Result<Configuration> floor_of(const Configuration& configuration, const Options& standard);

}  // namespace lumo::program
