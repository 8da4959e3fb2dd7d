#include "samples/lumo/report/plots.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <span>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr std::array colors{"#1f6fb4", "#d9622b", "#2a9d5c", "#8e5bb5", "#c43c5e", "#8a7a3c",
                            "#3fa7a3", "#5b5f97", "#b3882e", "#6c757d", "#a2577e", "#4d7c0f"};
constexpr size_t most_bars = 40, most_parts = 9;
constexpr double least_width = 0.002;  // of a part, over the longest bar: less is not seen

const char* color(size_t i) { return colors[i % colors.size()]; }

/// A string as gnuplot reads it in single quotes.
std::string gnuplot_string(std::string_view text) {
    std::string result = "'";
    for (const char c : scene::printable(text, 100))
        result += c == '\'' ? std::string("''") : std::string(1, c);
    return result + "'";
}

std::string file_of(std::string_view what, const DeviceFindings& device) {
    return fmt::format("{}.{}.svg", what, to_string(device.info.api));
}

std::string begin_plot(const std::string& file, int width, int height) {
    std::string name = file.substr(0, file.rfind('.'));
    std::ranges::replace_if(
        name, [](char c) { return c == '.' || c == '-'; }, '_');
    return fmt::format(
        "\nreset\nset terminal svg noenhanced size {},{} font 'sans-serif,12' name '{}' "
        "background '#ffffff'\nset output '{}'\nset grid lc rgb '#dddddd'\nset border lc rgb '#555555'\n",
        width, height, name, file);
}

/// Error against time of one device: a colour for each value of the setting that is varied first.
std::string error_time(const Findings& findings, const DeviceFindings& device) {
    struct Point {
        double ms, percent;
        const Configuration* configuration;
        bool on_front;
    };
    std::vector<Point> points;
    std::vector<std::string> values;  // of the setting that is varied first
    const auto value_of = [](const Point& point) {
        return point.configuration->varied.empty()
                   ? std::string("default")
                   : fmt::format("{} {}", point.configuration->varied.front().first,
                                 point.configuration->varied.front().second);
    };
    for (const Row& row : device.rows) {
        const LayerError* error = error_of(row.measured.errors, findings.layer);
        if (!error || !std::isfinite(error->relative_rmse)) continue;
        points.push_back({row.measured.gpu_ms, 100 * error->relative_rmse,
                          &findings.configurations[row.configuration], row.on_front});
        if (std::ranges::find(values, value_of(points.back())) == values.end())
            values.push_back(value_of(points.back()));
    }
    std::string text = begin_plot(file_of("error-time", device), 860, 480);
    if (points.empty()) return text;
    std::ranges::sort(points, {}, &Point::ms);
    for (size_t i = 0; i < values.size(); ++i) {
        text += fmt::format("$points{} << EOD\n", i);
        for (const Point& point : points)
            if (value_of(point) == values[i]) text += fmt::format("{:.6g} {:.6g}\n", point.ms, point.percent);
        text += "EOD\n";
    }
    text += "$front << EOD\n";
    for (const Point& point : points)
        if (point.on_front)
            text +=
                fmt::format("{:.6g} {:.6g} \"{}\"\n", point.ms, point.percent, point.configuration->label);
    text += "EOD\n$default << EOD\n";
    for (const Point& point : points)
        if (point.configuration->standard) text += fmt::format("{:.6g} {:.6g}\n", point.ms, point.percent);
    text += "EOD\n";

    const double highest = std::ranges::max(points, {}, &Point::percent).percent;
    const bool wide = points.back().ms > 8 * points.front().ms;
    text += fmt::format(
        "set xlabel 'GPU time of a frame, ms ({})'\nset ylabel 'relative RMSE of {}, %'\n"
        "set yrange [0:{:.6g}]\nset xrange [{:.6g}:{:.6g}]\nset key outside right top\n",
        to_string(device.info.api), frame::to_string(findings.layer), 1.1 * highest + 1e-6,
        wide ? 0.8 * points.front().ms : 0, (wide ? 1.6 : 1.15) * points.back().ms);
    if (wide) text += "set logscale x\n";
    text += "plot ";
    for (size_t i = 0; i < values.size(); ++i)
        text += fmt::format("$points{} using 1:2 with points pt 7 ps 0.7 lc rgb '{}' title {}, \\\n     ", i,
                            color(i), gnuplot_string(values[i]));
    text +=
        "$front using 1:2 with steps lw 1.5 lc rgb '#333333' title 'Pareto front', \\\n     "
        "$front using 1:2:3 with labels left offset character 0.4, character 0.6 font ',10' notitle, \\\n    "
        " "
        "$default using 1:2 with points pt 6 ps 1.6 lw 2 lc rgb '#000000' title 'default'\n";
    return text;
}

/// Bars from the top, each of stacked parts.
struct Bar {
    std::string label;
    std::map<std::string, double> parts;

    double sum() const {
        double all = 0;
        for (const auto& [name, value] : parts) all += value;
        return all;
    }
};

/// 1, 2 or 5 times a power of ten: at most 6 of them make `length`.
double tic_step(double length) {
    const double power = std::pow(10, std::floor(std::log10(std::max(length, 1e-9) / 6)));
    for (const double step : {1, 2, 5})
        if (length <= 6 * step * power) return step * power;
    return 10 * power;
}

std::string stacked(const std::string& file, std::vector<Bar> bars, const std::string& unit) {
    std::map<std::string, double> largest;
    for (const Bar& bar : bars)
        for (const auto& [name, value] : bar.parts) largest[name] = std::max(largest[name], value);
    std::vector<std::string> names;
    for (const auto& [name, value] : largest)
        if (value > 0) names.push_back(name);
    std::ranges::stable_sort(names, std::greater<>(), [&](const std::string& name) { return largest[name]; });
    const bool others = names.size() > most_parts + 1;
    if (others) names.resize(most_parts);

    std::string text = begin_plot(file, 860, 80 + 18 * int(std::max(bars.size(), most_parts + 1)));
    if (names.empty()) return text;
    const double longest = std::ranges::max(bars, {}, &Bar::sum).sum();
    std::vector<std::string> blocks(names.size() + (others ? 1 : 0));
    text += "set ytics (";
    for (size_t i = 0; i < bars.size(); ++i) {
        double end = 0;
        const auto add = [&](std::string& block, double value) {
            if (value > least_width * longest)
                block += fmt::format("{:.5g} {:.5g} {}\n", end, end + value, i);
            end += value;
        };
        for (size_t part = 0; part < names.size(); ++part) add(blocks[part], bars[i].parts[names[part]]);
        if (others) add(blocks.back(), bars[i].sum() - end);
        text += fmt::format("{}{} {}", i ? ", " : "", gnuplot_string(bars[i].label), i);
    }
    text += fmt::format(
        ")\nset yrange [{}:-1]\nset xrange [0:{:.5g}]\nset xtics {:.5g}\nset xlabel '{}'\n"
        "set key outside right top vertical maxcols 1\n"
        "set style fill solid 0.9 noborder\nunset grid\nset grid xtics lc rgb '#dddddd'\n",
        bars.size(), 1.02 * longest, tic_step(longest), unit);
    if (others) names.emplace_back("others");
    // Outside of the plot, so that a part that is too small to be seen still has its name.
    for (size_t part = 0; part < blocks.size(); ++part)
        text +=
            fmt::format("$part{} << EOD\n{}EOD\n", part, blocks[part].empty() ? "0 0 -9\n" : blocks[part]);
    text += "plot ";
    for (size_t part = 0; part < blocks.size(); ++part)
        text += fmt::format(
            "{}$part{} using (($1+$2)/2):3:1:2:($3-0.38):($3+0.38) with boxxyerror lc rgb '{}' title {}",
            part ? ", \\\n     " : "", part, color(part), gnuplot_string(names[part]));
    return text + "\n";
}

/// The configurations that fit into a plot, by time: all, or the front and the default.
std::vector<const Row*> shown_rows(const Findings& findings, const DeviceFindings& device) {
    std::vector<const Row*> rows;
    for (const Row& row : device.rows) {
        const bool chosen = row.on_front || findings.configurations[row.configuration].standard;
        if (row.measured.does_not_fit.empty() && (device.rows.size() <= most_bars || chosen))
            rows.push_back(&row);
    }
    std::ranges::sort(rows, {}, [](const Row* row) { return row->measured.gpu_ms; });
    if (rows.size() > most_bars) rows.resize(most_bars);
    return rows;
}

std::string label_of(const Findings& findings, const Row& row) {
    const Configuration& configuration = findings.configurations[row.configuration];
    return configuration.standard ? configuration.label + " (default)" : configuration.label;
}

std::string passes(const Findings& findings, const DeviceFindings& device) {
    std::vector<Bar> bars;
    for (const Row* row : shown_rows(findings, device)) {
        Bar& bar = bars.emplace_back(Bar{label_of(findings, *row), {}});
        for (const PassCost& pass : row->measured.passes) bar.parts[pass.name] += pass.gpu_ms;
    }
    return stacked(file_of("passes", device), std::move(bars),
                   fmt::format("GPU time by pass, ms ({})", to_string(device.info.api)));
}

/// What differs in nothing but settings that take no memory is one bar, of what these have in common.
std::string memory(const Findings& findings, const DeviceFindings& device) {
    constexpr double mib = 1 << 20;
    struct Group {
        std::map<std::string, double> parts;
        std::vector<SettingValue> common;
    };
    std::vector<Group> groups;
    for (const Row* row : shown_rows(findings, device)) {
        std::map<std::string, double> parts;
        for (const rhi::MemoryEntry& entry : row->measured.memory)
            parts[scene::printable(entry.name, 40)] += double(entry.bytes) / mib;
        const auto& varied = findings.configurations[row->configuration].varied;
        const auto found = std::ranges::find(groups, parts, &Group::parts);
        if (found == groups.end())
            groups.push_back({std::move(parts), varied});
        else
            std::erase_if(found->common, [&](const SettingValue& value) {
                return std::ranges::find(varied, value) == varied.end();
            });
    }
    std::vector<Bar> bars;
    for (Group& group : groups) {
        std::string label;
        for (const auto& [name, value] : group.common)
            label += fmt::format("{}{} {}", label.empty() ? "" : ", ", name, value);
        bars.push_back({label.empty() ? "all" : label, std::move(group.parts)});
    }
    std::ranges::sort(bars, {}, &Bar::sum);
    return stacked("memory.svg", std::move(bars),
                   fmt::format("device memory by resource, MiB ({})", to_string(device.info.api)));
}

}  // namespace

std::vector<Plot> plots_of(const Findings& findings) {
    std::vector<Plot> plots;
    for (const DeviceFindings& device : findings.devices) {
        const std::string_view api = to_string(device.info.api);
        plots.push_back({file_of("error-time", device), fmt::format("Error against time, {}", api)});
        plots.push_back({file_of("passes", device), fmt::format("Time by pass, {}", api)});
    }
    plots.push_back({"memory.svg", "Memory"});
    return plots;
}

std::string gnuplot_script(const Findings& findings) {
    std::string text = "# gnuplot THIS_FILE draws the plots of the report again.\n";
    for (const DeviceFindings& device : findings.devices)
        text += error_time(findings, device) + passes(findings, device);
    return text + memory(findings, findings.devices.front());
}

namespace {

Result<void> run_gnuplot(const std::filesystem::path& folder, const std::string& script) {
    const auto missing = [] {
        return fail(ErrorKind::unsupported, "gnuplot", "is not there, and the plots are left out",
                    "install the package gnuplot-nox and run the report again: nothing is measured twice");
    };
    std::string program = "gnuplot", argument = script;
    std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    pid_t child = 0;
    const int error = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error == ENOENT) return missing();
    if (error != 0)
        return fail(ErrorKind::io, "gnuplot", fmt::format("cannot be started: {}", std::strerror(error)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return fail(ErrorKind::io, "gnuplot", "fails with " + scene::printable((folder / script).string()),
                    "its message is above");
    return {};
}

/// gnuplot writes a group for every change of colour, most of which hold nothing.
std::string without_empty_groups(std::string_view svg) {
    std::string text;
    while (!svg.empty()) {
        const size_t begin = std::min(svg.find("<g "), svg.size());
        text += svg.substr(0, begin);
        svg.remove_prefix(begin);
        const size_t end = svg.find('>');
        if (end == std::string_view::npos) return text.append(svg);
        const size_t after = std::min(svg.find_first_not_of(" \t\r\n", end + 1), svg.size());
        constexpr std::string_view closing = "</g>";
        const bool empty = svg.substr(after).starts_with(closing);
        if (!empty) text += svg.substr(0, end + 1);
        svg.remove_prefix(empty ? after + closing.size() : end + 1);
    }
    return text;
}

}  // namespace

Result<void> draw_plots(const Findings& findings, const std::filesystem::path& folder,
                        const std::string& script) {
    if (Result<void> done = run_gnuplot(folder, script); !done) return done;
    for (const Plot& plot : plots_of(findings)) {
        const std::filesystem::path file = folder / plot.file;
        const auto bytes = scene::read_file(file);
        if (!bytes) return tl::unexpected(bytes.error());
        const std::string text =
            without_empty_groups({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
        if (Result<void> done = scene::write_file(file, std::as_bytes(std::span(text))); !done) return done;
    }
    return {};
}

}  // namespace lumo::program
