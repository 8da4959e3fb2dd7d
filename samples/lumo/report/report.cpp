// lumo report: error against run time.
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <span>
#include <spdlog/spdlog.h>

#include "samples/lumo/commands.hpp"
#include "samples/lumo/names.hpp"
#include "samples/lumo/report/findings.hpp"
#include "samples/lumo/report/page.hpp"
#include "samples/lumo/report/plots.hpp"
#include "samples/lumo/report/tables.hpp"
#include "samples/lumo/stats.hpp"
#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr rhi::Extent standard_size{320, 180};
constexpr uint32_t standard_runs = 15;

/// The options with what a report takes where they say nothing; radiance is always measured beside.
Result<Options> prepared(Options options) {
    if (!options.given.contains("size")) {
        options.frame.size = standard_size;
        options.settings["size"] = fmt::format("{}x{}", standard_size.width, standard_size.height);
    }
    if (!options.given.contains("runs")) options.runs = standard_runs;
    auto& layers = options.frame.layers;
    if (!options.given.contains("layer")) {
        layers = {frame::Layer::irradiance};
        options.settings["layer"] = frame::to_string(frame::Layer::irradiance);
    }
    for (const frame::Layer layer : layers) {
        const auto traced = reference::traced_layer_from_string(to_string(layer));
        using enum reference::TracedLayer;
        const bool light = traced && *traced != albedo && *traced != normal && *traced != depth;
        if (!light)
            return fail(ErrorKind::invalid_argument, "--layer",
                        fmt::format("{} is no light that the path tracer has", to_string(layer)),
                        "take irradiance, indirect, direct, specular or radiance");
    }
    if (!options.frame.wants(frame::Layer::radiance)) layers.push_back(frame::Layer::radiance);
    if (options.output.empty())
        options.output = std::filesystem::path(options.scene).stem().string() + "-report";
    return options;
}

Result<void> make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && std::filesystem::is_directory(folder, error)) return {};
    return fail(ErrorKind::io, scene::printable(folder.string()), "is no folder and cannot be made one",
                "name another with -o");
}

Result<void> write_text(const std::filesystem::path& file, const std::string& text) {
    return scene::write_file(file, std::as_bytes(std::span(text)));
}

Result<void> write(const Findings& findings, const std::filesystem::path& folder) {
    if (Result<void> done = write_json(folder / "report.json", to_json(findings)); !done) return done;
    if (Result<void> done = write_text(folder / "report.csv", to_csv(findings)); !done) return done;
    if (const std::string sky = sky_csv(findings); !sky.empty())
        if (Result<void> done = write_text(folder / "sky.csv", sky); !done) return done;
    const std::string script = "plots.gnuplot";
    if (Result<void> done = write_text(folder / script, gnuplot_script(findings)); !done) return done;
    const Result<void> plotted = draw_plots(findings, folder, script);
    if (!plotted && plotted.error().kind != ErrorKind::unsupported) return plotted;
    if (!plotted) spdlog::warn("{}", to_string(plotted.error()));
    return write_text(folder / "index.html",
                      page_of(findings, folder, plotted ? std::string() : to_string(plotted.error())));
}

/// The front and the default of each device, in a few lines.
std::string summary(const Findings& findings) {
    std::string text;
    for (const DeviceFindings& device : findings.devices) {
        text += fmt::format("{} on {}: the front, by time\n", to_string(device.info.api),
                            scene::printable(device.info.name));
        std::vector<const Row*> rows;
        for (const Row& row : device.rows)
            if (row.on_front || findings.configurations[row.configuration].standard) rows.push_back(&row);
        std::ranges::sort(rows, {}, [](const Row* row) { return row->measured.gpu_ms; });
        for (const Row* row : rows) {
            const Configuration& configuration = findings.configurations[row->configuration];
            const LayerError* error = error_of(row->measured.errors, findings.layer);
            if (!error) continue;
            text += fmt::format(
                "  {:<32}{:>10.2f} ms{:>9.2f} %{}\n", configuration.label, row->measured.gpu_ms,
                100 * error->relative_rmse,
                !configuration.standard ? ""
                : row->on_front         ? "  default"
                                : fmt::format("  default, {:.1f} % above the front", 100 * row->above_front));
        }
    }
    return text;
}

}  // namespace

std::string command_of(const Options& options) {
    std::string text = "lumo report " + shell_argument(options.scene);
    text += given_arguments(options, {"scene"});
    for (const std::string& axis : options.vary) text += " --vary " + shell_argument(axis);
    for (const std::string& more : options.also) text += " --also " + shell_argument(more);
    return text;
}

Result<int> report(const Options& asked) {
    const auto options = prepared(asked);
    if (!options) return tl::unexpected(options.error());
    // Before any folder is made or scene loaded.
    if (const auto fine = configurations_of(*options); !fine) return tl::unexpected(fine.error());
    if (const Result<void> made = make_folder(options->output); !made) return tl::unexpected(made.error());
    const auto findings = measure(*options, options->output);
    if (!findings) return tl::unexpected(findings.error());
    if (const Result<void> done = write(*findings, options->output); !done)
        return tl::unexpected(done.error());
    fmt::print("{}{}\n", summary(*findings), scene::printable((options->output / "index.html").string()));
    return exit_done;
}

}  // namespace lumo::program
