// What a report found out about one configuration on one device, and where it is kept while the rest is measured.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "samples/lumo/trial.hpp"

namespace lumo::program {

/// Something that the plan leaves out, and why.
struct LeftOut {
    std::string what;
    std::string why;
};

struct Measurement {
    std::string key =
        {};  ///< of all that it depends on: configuration, scene, camera, device, driver, program
    std::string api = {};
    std::string does_not_fit = {};  ///< why the device cannot have it; empty if all that follows was measured
    uint32_t runs = 0;
    double gpu_ms = 0;
    double gpu_ms_error = 0;
    uint64_t bytes = 0;
    std::vector<PassCost> passes = {};
    std::vector<rhi::MemoryEntry> memory = {};
    std::vector<LeftOut> left_out = {};
    std::vector<LayerError> errors = {};              ///< against as many bounces as the frame's
    std::vector<LayerError> errors_all_bounces = {};  ///< against all
};

nlohmann::ordered_json to_json(const Measurement& measurement);
/// Nothing if it is not what to_json makes.
std::optional<Measurement> measurement_of(const nlohmann::ordered_json& json);

/// What was measured, in a file of a JSON line each, written as soon as it is there.
class MeasurementLog {
  public:
    /// Reads what is there and is whole, of this program alone, which `program` names; the rest is dropped. The folder
    /// exists. Errors: io.
    static Result<MeasurementLog> open(const std::filesystem::path& file, const std::string& program);

    /// What was added under the key.
    const nlohmann::ordered_json* find(const std::string& key) const;
    std::optional<Measurement> find_measurement(const std::string& key) const;
    /// Errors: io.
    Result<void> add(const std::string& key, nlohmann::ordered_json json);
    Result<void> add(const Measurement& measurement) { return add(measurement.key, to_json(measurement)); }

  private:
    MeasurementLog(std::filesystem::path file, std::string program)
        : file_(std::move(file)), program_(std::move(program)) {}

    std::filesystem::path file_;
    std::string program_;
    std::map<std::string, nlohmann::ordered_json> known_;
};

}  // namespace lumo::program
