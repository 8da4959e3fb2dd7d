#include "samples/lumo/report/tables.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>

#include "samples/lumo/table.hpp"

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

using Cells = std::vector<std::string>;

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string(); }

void add_errors(Cells& cells, const std::vector<LayerError>& errors, frame::Layer layer) {
    const LayerError* error = error_of(errors, layer);
    for (const auto member :
         {&LayerError::relative_rmse, &LayerError::bias, &LayerError::percentile95, &LayerError::flip_mean})
        cells.push_back(error ? cell(error->*member) : "");
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
        for (const SkyFigures& figures : device.sky)
            json["devices"].back()["sky"].push_back(to_json(figures));
    }
    return json;
}

std::string to_csv(const Findings& findings) {
    Table table{.columns = {"api", "device", "driver"}, .rows = {}};
    for (const auto& [name, value] : findings.configurations.front().varied) table.columns.push_back(name);
    for (const char* name : {"default", "on_front", "above_front", "runs", "gpu_ms", "gpu_ms_error", "bytes"})
        table.columns.emplace_back(name);
    const auto& layers = findings.options.frame.layers;
    for (const frame::Layer layer : layers) {
        for (const char* against : {"", "all_bounces_"})
            for (const char* figure : {"relative_rmse", "bias", "percentile95_relative", "flip_mean"})
                table.columns.push_back(fmt::format("{}_{}{}", frame::to_string(layer), against, figure));
    }
    for (const char* name : {"floor_relative_rmse", "does_not_fit"}) table.columns.emplace_back(name);

    for (const DeviceFindings& device : findings.devices) {
        for (const Row& row : device.rows) {
            const Measurement& measured = row.measured;
            const Configuration& configuration = findings.configurations[row.configuration];
            Cells cells{std::string(to_string(device.info.api)), device.info.name, device.info.driver};
            for (const auto& [name, value] : configuration.varied) cells.push_back(value);
            cells.emplace_back(configuration.standard ? "1" : "0");
            cells.emplace_back(row.on_front ? "1" : "0");
            if (measured.does_not_fit.empty())
                cells.insert(cells.end(),
                             {cell(row.above_front), fmt::to_string(measured.runs), cell(measured.gpu_ms),
                              cell(measured.gpu_ms_error), fmt::to_string(measured.bytes)});
            else
                cells.resize(cells.size() + 5);
            for (const frame::Layer layer : layers) {
                add_errors(cells, measured.errors, layer);
                add_errors(cells, measured.errors_all_bounces, layer);
            }
            cells.push_back(row.floor ? cell(*row.floor) : "");
            cells.push_back(measured.does_not_fit);
            table.rows.push_back({.cells = std::move(cells)});
        }
    }
    return to_csv(table);
}

std::string sky_csv(const Findings& findings) {
    Table table{
        .columns = {"api", "device", "driver", "preset", "precomputation_ms", "bytes", "ns_per_pixel"},
        .rows = {}};
    const std::array errors{std::pair{"order1", &SkyFigures::order1},
                            std::pair{"radiance", &SkyFigures::radiance},
                            std::pair{"irradiance", &SkyFigures::irradiance}};
    for (const auto& [name, member] : errors)
        for (const char* figure : {"median", "worst", "noise"})
            table.columns.push_back(fmt::format("{}_{}", name, figure));
    for (const DeviceFindings& device : findings.devices) {
        for (const SkyFigures& sky : device.sky) {
            Cells cells{std::string(to_string(device.info.api)),
                        device.info.name,
                        device.info.driver,
                        sky.preset,
                        cell(sky.precomputation_ms),
                        fmt::to_string(sky.bytes),
                        cell(sky.ns_per_pixel)};
            for (const auto& [name, member] : errors)
                for (const double figure : {(sky.*member).median, (sky.*member).worst, (sky.*member).noise})
                    cells.push_back(cell(figure));
            table.rows.push_back({.cells = std::move(cells)});
        }
    }
    return table.rows.empty() ? std::string() : to_csv(table);
}

}  // namespace lumo::program
