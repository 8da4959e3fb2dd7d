#include "reference/metrics_report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumo::reference {

std::string to_text(const Comparison& c, size_t max_misses) {
    std::string text;
    const auto row = [&](const char* name, const std::string& value) {
        text += fmt::format("{:<28}{}\n", name, value);
    };
    const auto percent = [](double v) { return fmt::format("{:.4g} %", 100 * v); };

    row("size", fmt::format("{}x{}, {} channels", c.width, c.height, c.channels));
    row("pixels measured", fmt::format("{} of {}", c.pixels_kept, c.parity.pixels));
    row("mean", fmt::format("{:.6g} reference, {:.6g} test", c.mean_reference, c.mean_test));
    row("relative RMSE, 4x4 blocks", percent(c.relative_rmse));
    row("bias", percent(c.bias));
    row("95th percentile, relative", percent(c.percentile95_relative));
    row("FLIP, mean", c.exposure ? fmt::format("{:.4g} at {:+.2f} stops", c.flip_mean, *c.exposure)
                                 : fmt::format("{:.4g}", c.flip_mean));
    if (c.not_finite_reference + c.not_finite_test > 0) {
        row("values not finite",
            fmt::format("{} reference, {} test", c.not_finite_reference, c.not_finite_test));
    }

    const Parity& p = c.parity;
    row("parity", fmt::format("{}: {} of {} pixels beyond, {} identical", p.passed ? "passed" : "FAILED",
                              p.pixels_beyond, p.pixels, p.pixels_identical));
    row("  rule", fmt::format("relative {:g}, absolute {:g}, in {:g} % of the pixels", p.rule.relative,
                              p.rule.absolute, 100 * p.rule.fraction));
    row("  worst difference",
        fmt::format("{:.4g}; {:.4g} times the bound", p.worst_difference, p.worst_times_bound));
    const size_t shown = std::min(max_misses, p.misses.size());
    if (shown > 0)
        text += fmt::format("  {:>6} {:>6} {:>7} {:>14} {:>14} {:>12}\n", "x", "y", "channel", "a", "b",
                            "times bound");
    for (size_t i = 0; i < shown; ++i) {
        const ParityMiss& m = p.misses[i];
        text += fmt::format("  {:>6} {:>6} {:>7} {:>14.8g} {:>14.8g} {:>12.4g}\n", m.x, m.y, m.channel, m.a,
                            m.b, m.times_bound);
    }
    return text;
}

nlohmann::ordered_json to_json(const Comparison& c) {
    using Json = nlohmann::ordered_json;
    const Parity& p = c.parity;
    Json misses = Json::array();
    for (const ParityMiss& m : p.misses) {
        misses.push_back({{"x", m.x},
                          {"y", m.y},
                          {"channel", m.channel},
                          {"a", m.a},
                          {"b", m.b},
                          {"times_bound", m.times_bound}});
    }
    return {
        {"width", c.width},
        {"height", c.height},
        {"channels", c.channels},
        {"pixels_kept", c.pixels_kept},
        {"not_finite_reference", c.not_finite_reference},
        {"not_finite_test", c.not_finite_test},
        {"mean_reference", c.mean_reference},
        {"mean_test", c.mean_test},
        {"relative_rmse", c.relative_rmse},
        {"bias", c.bias},
        {"percentile95_relative", c.percentile95_relative},
        {"exposure", c.exposure ? Json(*c.exposure) : Json(nullptr)},
        {"flip_mean", c.flip_mean},
        {"parity",
         {{"passed", p.passed},
          {"rule",
           {{"relative", p.rule.relative}, {"absolute", p.rule.absolute}, {"fraction", p.rule.fraction}}},
          {"pixels", p.pixels},
          {"pixels_identical", p.pixels_identical},
          {"pixels_beyond", p.pixels_beyond},
          {"mean_magnitude", p.mean_magnitude},
          {"worst_difference", p.worst_difference},
          {"worst_times_bound", p.worst_times_bound},
          {"misses", misses}}},
    };
}

}  // namespace lumo::reference
