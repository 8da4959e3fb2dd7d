#include "samples/lumo/report/page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <span>

#include "samples/lumo/report/error_map.hpp"
#include "samples/lumo/report/plots.hpp"
#include "scene/file.hpp"
#include "scene/image_codec.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr double mib = 1 << 20;
constexpr uint64_t largest_plot = uint64_t(4) << 20;  // bytes

constexpr std::string_view style = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 1180px; margin: 2em auto; padding: 0 1em }
h1 { font-size: 1.5em } h2 { font-size: 1.15em; margin-top: 2em; border-bottom: 1px solid #ddd }
table { border-collapse: collapse; font-size: 13px } td, th { padding: 2px 8px; text-align: right; white-space: nowrap }
th { border-bottom: 1px solid #999; vertical-align: bottom } tr.front td { background: #eef5ec } tr.default td { font-weight: 600 }
td.text, th.text { text-align: left } td.wrap { white-space: normal; text-align: left }
.wide { overflow-x: auto } code { background: #f4f4f4; padding: 1px 4px }
figure { display: inline-block; margin: 0 10px 12px 0; vertical-align: top } figcaption { font-size: 13px }
figure img { display: block; width: 270px; image-rendering: pixelated; margin-bottom: 2px }
.legend { width: 270px; height: 12px; border: 1px solid #999 } .note { color: #555; font-size: 13px }
svg { max-width: 100%; height: auto })";

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](size_t at) { return at < bytes.size() ? uint32_t(bytes[at]) : 0; };
        const uint32_t word = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        for (size_t digit = 0; digit < 4; ++digit)
            text += i + digit <= bytes.size() ? digits[word >> (18 - 6 * digit) & 63] : '=';
    }
    return text;
}

std::string image(const scene::Image8& picture, const std::string& what) {
    return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", escaped(what),
                       base64(scene::codec::encode_png(picture)));
}

std::string percent(double part) { return std::isfinite(part) ? fmt::format("{:.2f}", 100 * part) : "∞"; }
std::string signed_percent(double part) {
    return std::isfinite(part) ? fmt::format("{:+.2f}", 100 * part) : "∞";
}

std::string facts(const Findings& findings) {
    const Options& options = findings.options;
    std::string text = fmt::format(
        "<p>Relative RMSE of 4×4-block means of <b>{}</b> against the path tracer, visible emitters and sky "
        "left out, "
        "over the GPU time of a whole frame at {}×{} pixels (median; ± its standard "
        "error).</p>\n<p><code>{}</code></p>\n"
        "<table><tr><th class=text>API</th><th class=text>device</th><th class=text>driver</th><th "
        "class=text>times</th></tr>\n",
        frame::to_string(findings.layer), options.frame.size.width, options.frame.size.height,
        escaped(command_of(options)));
    for (const DeviceFindings& device : findings.devices)
        text += fmt::format(
            "<tr><td class=text>{}</td><td class=text>{}</td><td class=text>{}</td><td "
            "class=text>{}</td></tr>\n",
            to_string(device.info.api), escaped(device.info.name), escaped(device.info.driver),
            device.info.timing == rhi::Timing::overlapped ? "passes may overlap" : "pass after pass");
    text += "</table>\n<p class=note>References: ";
    for (const TruthFacts& truth : findings.truths)
        text += fmt::format("{}{}, noise {} %", &truth == &findings.truths.front() ? "" : "; ",
                            truth.bounces ? fmt::format("--bounces {}", *truth.bounces) : "all bounces",
                            percent(truth.relative_noise));
    text +=
        fmt::format(" at {} samples a pixel. Built as {} {} by compiler {}; program {}.</p>\n", options.spp,
                    LUMO_VERSION, LUMO_BUILD_TYPE, escaped(__VERSION__), findings.program.substr(0, 12));
    for (const std::string& warning : findings.warnings)
        text += fmt::format("<p class=note>{}</p>\n", escaped(warning));
    return text;
}

std::string plots(const Findings& findings, const std::filesystem::path& folder,
                  const std::string& without_plots) {
    std::string text;
    if (!without_plots.empty()) return fmt::format("<h2>Plots</h2>\n<p>{}</p>\n", escaped(without_plots));
    std::string title;
    for (const Plot& plot : plots_of(findings)) {
        const auto bytes = scene::read_file(folder / plot.file, largest_plot);
        if (!bytes) continue;
        const std::string_view file(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        const size_t begin = file.find("<svg");
        if (begin == std::string_view::npos) continue;
        text += fmt::format("<h2>{}</h2>\n{}\n", plot.title, file.substr(begin));
    }
    return text;
}

std::string pictures(const Findings& findings) {
    std::string text = "<h2>Pictures</h2>\n";
    for (const Panel& panel : findings.panels) {
        text +=
            "<figure>" + image(panel.layer, panel.title) + image(panel.radiance, panel.title + ", radiance");
        if (panel.error) text += image(*panel.error, panel.title + ", error");
        text += fmt::format("<figcaption><b>{}</b><br>{}</figcaption></figure>\n", panel.title,
                            escaped(panel.subtitle));
    }
    std::string stops;
    for (int i = -10; i <= 10; i += 2) {
        const auto color = signed_color(i / 10.0);
        stops += fmt::format(", rgb({},{},{})", color[0], color[1], color[2]);
    }
    return text + fmt::format(
                      "<p class=note>From the top: {}, radiance (both tone-mapped at the reference's "
                      "exposure), and the "
                      "signed error of {} by blocks of 4×4 pixels, as a part of the reference's mean; grey "
                      "is left out.</p>\n"
                      "<div class=legend style=\"background:linear-gradient(to right{})\"></div>"
                      "<p class=note>−{:.0f} % &nbsp; too dark &nbsp;·&nbsp; 0 &nbsp;·&nbsp; too bright "
                      "&nbsp; +{:.0f} %</p>\n",
                      frame::to_string(findings.layer), frame::to_string(findings.layer), stops,
                      100 * error_map_range, 100 * error_map_range);
}

std::string row_of(const Findings& findings, const DeviceFindings& device, const Row& row) {
    const Configuration& configuration = findings.configurations[row.configuration];
    const Measurement& measured = row.measured;
    std::string text = fmt::format("<tr class=\"{}{}\"><td class=text>{}</td>", row.on_front ? "front " : "",
                                   configuration.standard ? "default" : "", to_string(device.info.api));
    for (const auto& [name, value] : configuration.varied)
        text += fmt::format("<td class=text>{}</td>", escaped(value));
    const LayerError* error = error_of(measured.errors, findings.layer);
    const LayerError* of_all = error_of(measured.errors_all_bounces, findings.layer);
    const LayerError* radiance = error_of(measured.errors, frame::Layer::radiance);
    if (!measured.does_not_fit.empty() || !error || !of_all || !radiance)
        return text + fmt::format("<td class=wrap colspan=13>{}</td></tr>\n", escaped(measured.does_not_fit));
    text += fmt::format("<td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{:.1f}</td>", measured.gpu_ms,
                        measured.gpu_ms_error, measured.runs, double(measured.bytes) / mib);
    for (const std::string& figure :
         {percent(error->relative_rmse), signed_percent(error->bias), percent(error->percentile95),
          row.floor ? percent(*row.floor) : "",
          row.floor && *row.floor > 0 ? fmt::format("{:.2f}", error->relative_rmse / *row.floor) : "",
          row.on_front ? "" : percent(row.above_front), percent(of_all->relative_rmse),
          signed_percent(of_all->bias), fmt::format("{:.4f}", radiance->flip_mean)})
        text += fmt::format("<td>{}</td>", figure);
    return text + "</tr>\n";
}

std::string table(const Findings& findings) {
    std::string text = "<h2>Configurations</h2>\n<div class=wide><table>\n<tr><th class=text>API</th>";
    for (const auto& [name, value] : findings.configurations.front().varied)
        text += fmt::format("<th class=text>{}</th>", escaped(name));
    text +=
        "<th>ms</th><th>±</th><th>frames</th><th>MiB</th><th>RMSE %</th><th>bias "
        "%</th><th>95th<br>percentile %</th>"
        "<th>floor %</th><th>over<br>floor</th><th>above<br>front %</th><th>all bounces:<br>RMSE "
        "%</th><th>bias %</th><th>ꟻLIP "
        "of<br>radiance</th></tr>\n";
    for (const DeviceFindings& device : findings.devices) {
        std::vector<const Row*> rows;
        for (const Row& row : device.rows) rows.push_back(&row);
        std::ranges::stable_sort(rows, {}, [](const Row* row) { return row->measured.gpu_ms; });
        for (const Row* row : rows) text += row_of(findings, device, *row);
    }
    return text +
           "</table></div>\n<p class=note>Green: on the Pareto front. Bold: the default. Floor: the RMSE of "
           "many rays "
           "through the same voxels in place of cones. Above front: the error over the least that is to be "
           "had in the "
           "same time. All bounces: against light that is reflected any number of times.</p>\n";
}

std::string left_out(const Findings& findings) {
    const size_t standard = size_t(&findings.standard() - findings.configurations.data());
    std::string text =
        "<h2>What the default's frame leaves out</h2>\n<table><tr><th class=text>left out</th>"
        "<th class=text>why</th></tr>\n";
    for (const LeftOut& item : findings.devices.front().rows[standard].measured.left_out)
        text += fmt::format("<tr><td class=text>{}</td><td class=text>{}</td></tr>\n", escaped(item.what),
                            escaped(item.why));
    text += "</table>\n";
    for (const DeviceFindings& device : findings.devices) {
        const Measurement &plan = device.rows[standard].measured, &full = device.full_plan;
        if (!plan.does_not_fit.empty() || !full.does_not_fit.empty()) continue;
        text += fmt::format(
            "<p>{}: with nothing left out (<code>--plan full</code>) a frame takes {:.2f} ms instead of "
            "{:.2f} ms and {:.1f} MiB instead of {:.1f} MiB.</p>\n",
            to_string(device.info.api), full.gpu_ms, plan.gpu_ms, double(full.bytes) / mib,
            double(plan.bytes) / mib);
    }
    return text;
}

std::string sky(const Findings& findings) {
    if (findings.devices.front().sky.empty()) return "";
    std::string text =
        "<h2>The sky's tables</h2>\n<table>\n<tr><th class=text>API</th><th class=text>preset</th>"
        "<th>precomputation<br>ms</th><th>MiB</th><th>ns a<br>pixel</th>";
    for (const char* of : {"order 1", "radiance", "irradiance"})
        text += fmt::format("<th>{}:<br>median %</th><th>worst %</th>", of);
    text += "<th>noise of<br>the truth %</th></tr>\n";
    for (const DeviceFindings& device : findings.devices) {
        for (const SkyFigures& sky : device.sky) {
            text += fmt::format(
                "<tr><td class=text>{}</td><td "
                "class=text>{}</td><td>{:.0f}</td><td>{:.1f}</td><td>{:.0f}</td>",
                to_string(device.info.api), escaped(sky.preset), sky.precomputation_ms,
                double(sky.bytes) / mib, sky.ns_per_pixel);
            for (const SkyError& error : {sky.order1, sky.radiance, sky.irradiance})
                text += fmt::format("<td>{}</td><td>{}</td>", percent(error.median), percent(error.worst));
            text += fmt::format("<td>{}</td></tr>\n",
                                percent(std::max(sky.radiance.noise, sky.irradiance.noise)));
        }
    }
    return text +
           "</table>\n<p class=note>Against the double-precision reference, from the scene's origin under "
           "its "
           "own sun "
           "and at 30°, 75° and 88°: four views each for radiance of order 1, which the truth has exactly, "
           "and of all "
           "orders, and the irradiance of the sky, which it samples. Of the worst wavelength, relative to "
           "the "
           "greater of "
           "the truth and a thousandth of the brightest view under that sun. Times are wall times; a pixel "
           "is one of a "
           "panorama. Presets that take longer than the frame's are measured with "
           "<code>--preset</code>.</p>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : scene::printable(text, 4000)) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string page_of(const Findings& findings, const std::filesystem::path& folder,
                    const std::string& without_plots) {
    const std::string title = escaped(findings.options.scene) + ": error against run time";
    return fmt::format(
               "<!DOCTYPE html>\n<html lang=en><meta "
               "charset=utf-8><title>{}</title>\n<style>{}</style>\n<h1>{}</h1>\n",
               title, style, title) +
           facts(findings) + plots(findings, folder, without_plots) + pictures(findings) + table(findings) +
           sky(findings) + left_out(findings) + "</html>\n";
}

}  // namespace lumo::program
