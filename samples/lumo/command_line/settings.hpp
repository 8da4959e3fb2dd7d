// Settings: the options that --stats writes and --config reads, and that trials vary.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "rhi/error.hpp"
#include "samples/lumo/options.hpp"

namespace lumo::program {

/// By their names without dashes.
using SettingOptions = std::vector<std::pair<std::string, CLI::Option*>>;

/// How a frame is made: what changes its time and its error, and not what it shows.
SettingOptions add_technique_settings(CLI::App& app, Options& options);
/// A scene and how a frame of it is made.
SettingOptions add_scene_settings(CLI::App& app, Options& options);
/// Which devices draw. `apis`: help on --api.
SettingOptions add_device_settings(CLI::App& app, Options& options, const std::string& apis);
/// What draws, and what it sees of the scene.
SettingOptions add_view_settings(CLI::App& app, Options& options, const std::string& apis);
/// What a picture depends on beside.
SettingOptions add_picture_settings(CLI::App& app, Options& options);
CLI::Option* add_spp(CLI::App& app, Options& options);
CLI::Option* add_runs(CLI::App& app, Options& options, const std::string& help);

/// A setting's value as the command line would give it.
std::string as_argument(const nlohmann::ordered_json& value);
/// Gives an option a value as the command line would. Errors: invalid_argument.
Result<void> give(CLI::Option& option, const std::string& value);
/// Gives options the values of a file where the command line has none. Errors: io, invalid_file.
Result<void> read_config(const std::filesystem::path& file, const SettingOptions& settings);
/// The value of each setting as its JSON form: numbers, true and false, or text. A setting that has neither a
/// value nor a default is left out.
nlohmann::ordered_json collect(const SettingOptions& settings);
/// What could have been said instead.
std::string names_of(const SettingOptions& settings);

}  // namespace lumo::program
