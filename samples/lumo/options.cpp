#include "samples/lumo/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "samples/lumo/command_line/arguments.hpp"
#include "samples/lumo/command_line/settings.hpp"
#include "samples/lumo/command_line/subcommands.hpp"
#include "samples/lumo/names.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

using NamedCommand = std::pair<std::string_view, Command>;
constexpr std::array<NamedCommand, 8> commands{{{"render", Command::render},
                                                {"check", Command::check},
                                                {"diff", Command::diff},
                                                {"devices", Command::devices},
                                                {"bench", Command::bench},
                                                {"probe", Command::probe},
                                                {"report", Command::report},
                                                {"tune", Command::tune}}};

Refusal refusal(const std::string& prefix, const std::string& text) {
    return {.exit_code = exit_failed, .text = prefix + ": " + text};
}

std::string option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_positional()) names.push_back(option->get_name());
    }
    return available(names);
}

}  // namespace

Result<Options> with_settings(const Options& options, const std::vector<SettingValue>& values) {
    Options changed = options;
    CLI::App app;
    const SettingOptions settings = add_technique_settings(app, changed);
    for (const auto& [name, value] : values) {
        const auto setting = std::ranges::find(settings, name, &SettingOptions::value_type::first);
        if (setting == settings.end())
            return fail(ErrorKind::invalid_argument, fmt::format("'{}'", scene::printable(name)),
                        "is no setting that can be varied", names_of(settings));
        if (Result<void> given = give(*setting->second, value); !given) return tl::unexpected(given.error());
        changed.settings.update(collect({*setting}));
        changed.given.insert(name);
    }
    return changed;
}

Json technique_settings(const Options& options) {
    Options unused;
    CLI::App app;
    Json all = Json::object();
    for (const auto& [name, option] : add_technique_settings(app, unused))
        if (options.settings.contains(name)) all[name] = options.settings[name];
    return all;
}

std::string value_of(const Options& options, const std::string& setting) {
    return options.settings.contains(setting) ? as_argument(options.settings[setting]) : "";
}

std::string given_arguments(const Options& options, std::initializer_list<std::string_view> elsewhere) {
    std::string text;
    for (const auto& [name, value] : options.settings.items()) {
        if (!options.given.contains(name) || std::ranges::find(elsewhere, name) != elsewhere.end()) continue;
        text += " --" + name;
        if (!value.is_boolean()) text += " " + shell_argument(as_argument(value));
    }
    return text;
}

tl::expected<Options, Refusal> parse_options(int argc, const char* const* argv) {
    Options options;
    CLI::App app{"lumo: real-time global illumination on OpenGL and Vulkan", "lumo"};
    app.get_formatter()->column_width(name_column);
    app.require_subcommand(0, 1);
    bool version = false;
    add_flag(app, "--version", version, "the build, and the drivers");
    app.footer(
        "Each subcommand has a --help with examples.\n\n"
        "Exit codes: 0 all was done; 1 two pictures differ by more than they may; 2 something failed.");

    std::filesystem::path config;
    const SettingOptions render_settings = add_render(
        *app.add_subcommand("render", "Renders a scene to a picture, without a window."), options, config);
    const SettingOptions check_settings = add_check(
        *app.add_subcommand("check", "Says what a scene holds, and what a frame of it needs and leaves out."),
        options);
    add_diff(*app.add_subcommand("diff", "Compares two pictures."), options);
    add_devices(*app.add_subcommand("devices", "Lists the devices that each API finds."), options);

    const SettingOptions bench_settings =
        add_bench(*app.add_subcommand("bench", "Measures what is to be fast."), options);

    add_probe(*app.add_subcommand("probe", "Answers with numbers instead of pictures."), options);

    const SettingOptions report_settings = add_report(
        *app.add_subcommand("report", "Measures error against run time, by configuration."), options);
    const SettingOptions tune_settings = add_tune(
        *app.add_subcommand("tune", "Finds the configuration that keeps a bound on error or time."), options);

    const auto is_command = [](std::string_view name) {
        return std::ranges::find(commands, name, &NamedCommand::first) != commands.end();
    };
    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) {
        std::vector<std::string_view> names;
        for (const NamedCommand& command : commands) names.push_back(command.first);
        return tl::unexpected(refusal("lumo", fmt::format("there is no subcommand '{}' ({})",
                                                          scene::printable(argv[1]), available(names))));
    }

    const auto chosen = [&]() -> const CLI::App& {
        return app.get_subcommands().empty() ? app : *app.get_subcommands().front();
    };
    const auto refuse = [&](const std::string& text) {
        return tl::unexpected(
            refusal(app.get_subcommands().empty() ? "lumo" : "lumo " + chosen().get_name(), text));
    };
    try {
        app.parse(argc, argv);
    } catch (const CLI::ExtrasError& error) {
        return refuse(fmt::format("{} ({})", scene::printable(error.what(), 1000), option_names(chosen())));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == int(CLI::ExitCodes::Success))
            return tl::unexpected(Refusal{.exit_code = exit_done, .text = app.help()});
        return refuse(scene::printable(error.what(), 1000));
    }
    if (version) {
        options.command = Command::version;
        return options;
    }
    if (app.get_subcommands().empty()) return tl::unexpected(Refusal{.text = app.help()});

    options.command = std::ranges::find(commands, chosen().get_name(), &NamedCommand::first)->second;
    if (options.probe.truth.last_order != reference::all_orders)
        options.probe.settings.orders = options.probe.truth.last_order;
    if (!config.empty()) {
        if (const Result<void> done = read_config(config, render_settings); !done)
            return refuse(to_string(done.error()));
    }
    const SettingOptions& settings = options.command == Command::check    ? check_settings
                                     : options.command == Command::bench  ? bench_settings
                                     : options.command == Command::report ? report_settings
                                     : options.command == Command::tune   ? tune_settings
                                                                          : render_settings;
    options.settings = collect(settings);
    for (const auto& [name, option] : settings)
        if (option->count() > 0) options.given.insert(name);
    return options;
}

}  // namespace lumo::program
