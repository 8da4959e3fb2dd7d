// The subcommands, each with its options, help and examples.
#pragma once

#include <CLI/CLI.hpp>

#include "samples/lumo/command_line/settings.hpp"

namespace lumo::program {

/// Those that take settings return them.
SettingOptions add_render(CLI::App& app, Options& options, std::filesystem::path& config);
SettingOptions add_check(CLI::App& app, Options& options);
SettingOptions add_report(CLI::App& app, Options& options);
SettingOptions add_tune(CLI::App& app, Options& options);
SettingOptions add_bench(CLI::App& app, Options& options);
void add_diff(CLI::App& app, Options& options);
void add_devices(CLI::App& app, Options& options);
void add_probe(CLI::App& app, Options& options);

}  // namespace lumo::program
