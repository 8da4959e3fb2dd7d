#include "samples/lumo/report/measurement.hpp"

#include <fstream>
#include <limits>

#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const std::vector<LayerError>& errors) {
    Json json = Json::object();
    for (const LayerError& error : errors)
        json[std::string(frame::to_string(error.layer))] = {{"relative_rmse", error.relative_rmse},
                                                            {"bias", error.bias},
                                                            {"percentile95_relative", error.percentile95},
                                                            {"flip_mean", error.flip_mean}};
    return json;
}

std::vector<LayerError> errors_of(const Json& json) {
    // What is infinite is null in JSON.
    const auto number = [](const Json& value) {
        return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
    };
    std::vector<LayerError> errors;
    for (const auto& [name, error] : json.items())
        errors.push_back({.layer = frame::layer_from_string(name).value_or(frame::Layer::irradiance),
                          .relative_rmse = number(error.at("relative_rmse")),
                          .bias = number(error.at("bias")),
                          .percentile95 = number(error.at("percentile95_relative")),
                          .flip_mean = number(error.at("flip_mean"))});
    return errors;
}

}  // namespace

Json to_json(const Measurement& measurement) {
    Json json{{"key", measurement.key}, {"api", measurement.api}};
    if (!measurement.does_not_fit.empty()) {
        json["does_not_fit"] = measurement.does_not_fit;
        return json;
    }
    json["runs"] = measurement.runs;
    json["gpu_ms"] = measurement.gpu_ms;
    json["gpu_ms_error"] = measurement.gpu_ms_error;
    json["bytes"] = measurement.bytes;
    json["errors"] = to_json(measurement.errors);
    json["errors_all_bounces"] = to_json(measurement.errors_all_bounces);
    Json &passes = json["passes"] = Json::object(), &memory = json["memory"] = Json::object(),
         &left_out = json["left_out"] = Json::object();
    for (const PassCost& pass : measurement.passes) passes[pass.name] = pass.gpu_ms;
    for (const rhi::MemoryEntry& entry : measurement.memory)
        memory[entry.name] = memory.value(entry.name, uint64_t(0)) + entry.bytes;
    for (const LeftOut& item : measurement.left_out) left_out[item.what] = item.why;
    return json;
}

std::optional<Measurement> measurement_of(const Json& json) {
    try {
        Measurement measurement{.key = json.at("key"), .api = json.at("api")};
        if (json.contains("does_not_fit")) {
            measurement.does_not_fit = json["does_not_fit"];
            return measurement;
        }
        measurement.runs = json.at("runs");
        measurement.gpu_ms = json.at("gpu_ms");
        measurement.gpu_ms_error = json.at("gpu_ms_error");
        measurement.bytes = json.at("bytes");
        measurement.errors = errors_of(json.at("errors"));
        measurement.errors_all_bounces = errors_of(json.at("errors_all_bounces"));
        for (const auto& [name, gpu_ms] : json.at("passes").items())
            measurement.passes.push_back({.name = name, .gpu_ms = gpu_ms});
        for (const auto& [name, bytes] : json.at("memory").items())
            measurement.memory.push_back({.name = name, .bytes = bytes});
        for (const auto& [what, why] : json.at("left_out").items())
            measurement.left_out.push_back({.what = what, .why = why});
        return measurement;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

Result<MeasurementLog> MeasurementLog::open(const std::filesystem::path& file, const std::string& program) {
    MeasurementLog log(file, program);
    std::ifstream stream(file, std::ios::binary);
    for (std::string line; std::getline(stream, line);) {
        const Json json = Json::parse(line, nullptr, false);
        if (!json.is_object() || json.value("program", "") != program) continue;
        if (json.contains("key") && json["key"].is_string()) log.known_[json["key"]] = json;
    }
    stream.close();
    // Written anew, so that what follows does not end a line that was torn.
    const std::filesystem::path whole = file.string() + ".part";
    MeasurementLog part(whole, program);
    std::error_code error;
    std::filesystem::remove(whole, error);
    for (const auto& [key, json] : log.known_)
        if (Result<void> done = part.add(key, json); !done) return tl::unexpected(done.error());
    std::filesystem::remove(file, error);
    if (!log.known_.empty()) std::filesystem::rename(whole, file, error);
    if (error)
        return fail(ErrorKind::io, scene::printable(file.string()), "cannot be replaced: " + error.message(),
                    "check that its folder may be written to");
    return log;
}

const Json* MeasurementLog::find(const std::string& key) const {
    const auto found = known_.find(key);
    return found == known_.end() ? nullptr : &found->second;
}

std::optional<Measurement> MeasurementLog::find_measurement(const std::string& key) const {
    const Json* json = find(key);
    return json ? measurement_of(*json) : std::nullopt;
}

Result<void> MeasurementLog::add(const std::string& key, Json json) {
    json["program"] = program_;
    json["key"] = key;
    std::ofstream stream(file_, std::ios::binary | std::ios::app);
    stream << json.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
    stream.close();
    if (!stream)
        return fail(ErrorKind::io, scene::printable(file_.string()), "cannot be written",
                    "check that its folder may be written to and has room");
    known_[key] = std::move(json);
    return {};
}

}  // namespace lumo::program
