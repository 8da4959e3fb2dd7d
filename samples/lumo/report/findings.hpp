// All that a report says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rhi/device_info.hpp"
#include "samples/lumo/report/configurations.hpp"
#include "samples/lumo/report/measurement.hpp"
#include "samples/lumo/report/sky.hpp"
#include "scene/image.hpp"

namespace lumo::program {

/// One configuration on one device. Errors are those of Findings::layer.
struct Row {
    size_t configuration = 0;  ///< its place in Findings::configurations
    Measurement measured;
    std::optional<double> floor = {};  ///< relative RMSE that many rays through the same voxels have
    bool on_front = false;             ///< none is both faster and more accurate
    double above_front = 0;            ///< its error over the least at its time, minus 1
};

struct DeviceFindings {
    rhi::DeviceInfo info;
    std::vector<Row> rows = {};        ///< by place of the configuration
    Measurement full_plan = {};        ///< the standard configuration with nothing left out
    std::vector<SkyFigures> sky = {};  ///< of the presets up to the frame's; none where the scene has no sky
};

/// A path-traced reference.
struct TruthFacts {
    std::optional<uint32_t> bounces;  ///< none: all
    double relative_noise = 0;        ///< of Findings::layer, as a relative RMSE; adds in squares
};

/// Pictures of one configuration, sRGB-encoded; the reference has no error.
struct Panel {
    std::string title;
    std::string subtitle;
    scene::Image8 layer, radiance;
    std::optional<scene::Image8> error = {};  ///< error_map() of the layer
};

struct Findings {
    Options options;  ///< without what --vary and --also change
    frame::Layer layer = frame::Layer::irradiance;
    std::string program;  ///< names the program's build
    std::vector<TruthFacts> truths = {};
    std::vector<Configuration> configurations = {};
    std::vector<DeviceFindings> devices = {};  ///< one at least
    std::vector<Panel> panels = {};            ///< the first device's
    std::vector<std::string> warnings = {};

    const Configuration& standard() const;
};

/// Those of Findings::layer; none where it was not measured.
const LayerError* error_of(const std::vector<LayerError>& errors, frame::Layer layer);

/// The command line that makes the report again.
std::string command_of(const Options& options);

/// Measures what the options ask for; what the log of an interrupted report in `folder` has is taken from there. Errors:
/// those of what is asked for, of the scene, the devices and the path tracer.
Result<Findings> measure(const Options& options, const std::filesystem::path& folder);

}  // namespace lumo::program
