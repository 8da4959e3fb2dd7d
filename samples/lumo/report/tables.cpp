#include "samples/lumo/report/tables.hpp"

#include <cmath>
#include <fmt/format.h>

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

Json settings_of(const std::vector<SettingValue>& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values) json[name] = value;
    return json;
}

Json to_json(const Row& row, const Configuration& configuration) {
    Json json{{"label", configuration.label},
              {"settings", settings_of(configuration.varied)},
              {"default", configuration.standard},
              {"on_front", row.on_front},
              {"above_front", row.above_front},
              {"floor_relative_rmse", row.floor ? Json(*row.floor) : Json(nullptr)}};
    json.update(to_json(row.measured));
    if (!configuration.standard) json.erase("left_out");  // it differs in next to nothing
    return json;
}

/// Fields of a line, by commas.
class Line {
  public:
    void add(std::string_view text) {
        if (!std::exchange(first_, false)) text_ += ',';
        if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
            text_ += text;
            return;
        }
        text_ += '"';
        for (const char c : text) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
        text_ += '"';
    }
    void add(double value) { add(std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string()); }
    void add(uint64_t value) { add(fmt::to_string(value)); }

    std::string ended() const { return text_ + '\n'; }

  private:
    std::string text_;
    bool first_ = true;
};

void add_errors(Line& line, const std::vector<LayerError>& errors, frame::Layer layer) {
    const LayerError* error = error_of(errors, layer);
    for (const auto member :
         {&LayerError::relative_rmse, &LayerError::bias, &LayerError::percentile95, &LayerError::flip_mean})
        error ? line.add(error->*member) : line.add(std::string_view());
}

}  // namespace

Json to_json(const Findings& findings) {
    const Options& options = findings.options;
    Json json{{"scene", options.scene},
              {"command", command_of(options)},
              {"program",
               {{"version", LUMO_VERSION},
                {"build_type", LUMO_BUILD_TYPE},
                {"compiler", __VERSION__},
                {"content", findings.program}}},
              {"size", {options.frame.size.width, options.frame.size.height}},
              {"settings", options.settings},
              {"layer", frame::to_string(findings.layer)},
              {"references", Json::array()},
              {"devices", Json::array()},
              {"warnings", findings.warnings}};
    for (const TruthFacts& truth : findings.truths)
        json["references"].push_back({{"bounces", truth.bounces ? Json(*truth.bounces) : Json("all")},
                                      {"spp", options.spp},
                                      {"relative_noise", truth.relative_noise}});
    for (const DeviceFindings& device : findings.devices) {
        Json rows = Json::array();
        for (const Row& row : device.rows)
            rows.push_back(to_json(row, findings.configurations[row.configuration]));
        json["devices"].push_back(
            {{"api", to_string(device.info.api)},
             {"device", device.info.name},
             {"driver", device.info.driver},
             {"timing_mode", device.info.timing == rhi::Timing::overlapped ? "overlapped" : "serialised"},
             {"configurations", std::move(rows)},
             {"nothing_left_out", to_json(device.full_plan)}});
    }
    return json;
}

std::string to_csv(const Findings& findings) {
    Line head;
    for (const char* name : {"api", "device", "driver"}) head.add(name);
    for (const auto& [name, value] : findings.configurations.front().varied) head.add(name);
    for (const char* name : {"default", "on_front", "above_front", "runs", "gpu_ms", "gpu_ms_error", "bytes"})
        head.add(name);
    const auto& layers = findings.options.frame.layers;
    for (const frame::Layer layer : layers) {
        for (const char* against : {"", "all_bounces_"})
            for (const char* figure : {"relative_rmse", "bias", "percentile95_relative", "flip_mean"})
                head.add(fmt::format("{}_{}{}", frame::to_string(layer), against, figure));
    }
    for (const char* name : {"floor_relative_rmse", "does_not_fit"}) head.add(name);

    std::string text = head.ended();
    for (const DeviceFindings& device : findings.devices) {
        for (const Row& row : device.rows) {
            const Measurement& measured = row.measured;
            const Configuration& configuration = findings.configurations[row.configuration];
            Line line;
            line.add(to_string(device.info.api));
            line.add(device.info.name);
            line.add(device.info.driver);
            for (const auto& [name, value] : configuration.varied) line.add(value);
            line.add(uint64_t(configuration.standard));
            line.add(uint64_t(row.on_front));
            if (measured.does_not_fit.empty()) {
                line.add(row.above_front);
                line.add(uint64_t(measured.runs));
                line.add(measured.gpu_ms);
                line.add(measured.gpu_ms_error);
                line.add(measured.bytes);
            } else {
                for (int i = 0; i < 5; ++i) line.add(std::string_view());
            }
            for (const frame::Layer layer : layers) {
                add_errors(line, measured.errors, layer);
                add_errors(line, measured.errors_all_bounces, layer);
            }
            row.floor ? line.add(*row.floor) : line.add(std::string_view());
            line.add(measured.does_not_fit);
            text += line.ended();
        }
    }
    return text;
}

}  // namespace lumo::program
