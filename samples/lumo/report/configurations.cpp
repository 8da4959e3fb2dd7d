#include "samples/lumo/report/configurations.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "samples/lumo/values.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr size_t most_configurations = 10'000;

/// Combinations that show what each of the settings that matter most is worth, in minutes also on the CPU.
const std::array<std::string, 4> standard_axes{"voxels=64,128", "cones=3,6,9,18", "mips=iso,ani",
                                               "rotate-cones=off,on"};

Result<SettingValue> setting_of(std::string_view text, std::string_view option, std::string_view form) {
    const size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
        return fail(ErrorKind::invalid_argument, fmt::format("{} '{}'", option, scene::printable(text)),
                    fmt::format("expected {}", form));
    return SettingValue{std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

/// Where a configuration came from goes into its errors.
Result<Options> with_settings_of(const Options& options, const std::vector<SettingValue>& values,
                                 std::string_view option) {
    Result<Options> changed = with_settings(options, values);
    if (!changed) changed.error().subject = fmt::format("{} {}", option, changed.error().subject);
    return changed;
}

Result<std::vector<Options>> combinations_of(const Options& options) {
    std::vector<std::string> axes = options.vary;
    if (axes.empty() && options.also.empty()) axes.assign(standard_axes.begin(), standard_axes.end());
    std::vector<Options> all{options};
    for (const std::string& text : axes) {
        const auto axis = setting_of(text, "--vary", "NAME=V1,V2,..., as voxels=64,128");
        if (!axis) return tl::unexpected(axis.error());
        std::vector<Options> wider;
        for (const Options& each : all) {
            for (const std::string_view value : split(axis->second, ',')) {
                auto changed = with_settings_of(each, {{axis->first, std::string(value)}}, "--vary");
                if (!changed) return tl::unexpected(changed.error());
                wider.push_back(std::move(*changed));
            }
            if (wider.size() > most_configurations)
                return fail(ErrorKind::limit, "--vary",
                            fmt::format("there are more than {} combinations", most_configurations),
                            "vary fewer values");
        }
        all = std::move(wider);
    }
    // Without --vary what --also adds is all there is beside the standard configuration.
    if (axes.empty()) all.clear();
    for (const std::string& text : options.also) {
        std::vector<SettingValue> values;
        for (const std::string_view part : split(text, ',')) {
            const auto value = setting_of(part, "--also", "NAME=V,NAME=V,..., as voxels=256,cones=18");
            if (!value) return tl::unexpected(value.error());
            values.push_back(*value);
        }
        auto changed = with_settings_of(options, values, "--also");
        if (!changed) return tl::unexpected(changed.error());
        all.push_back(std::move(*changed));
    }
    return all;
}

/// As short as it can be while a reader of the options still knows it.
std::string label_of(const std::vector<SettingValue>& varied) {
    std::string label;
    for (const auto& [name, value] : varied) {
        if (!label.empty()) label += ' ';
        const bool number = value.find_first_not_of("0123456789") == std::string::npos;
        const bool flag = value == "on" || value == "off";
        if (number)
            label += value + name.substr(0, 1);
        else if (flag)
            label += (value == "on" ? "+" : "-") + name.substr(0, name.find('-'));
        else
            label += value;
    }
    return label;
}

}  // namespace

Result<std::vector<Configuration>> configurations_of(const Options& options) {
    auto combinations = combinations_of(options);
    if (!combinations) return tl::unexpected(combinations.error());
    std::vector<Configuration> all;
    const auto add = [&](Options each) {
        const bool known = std::ranges::any_of(
            all, [&](const Configuration& other) { return other.options.settings == each.settings; });
        const bool standard = each.settings == options.settings;
        if (!known) all.push_back({.options = std::move(each), .standard = standard});
    };
    for (Options& each : *combinations) add(std::move(each));
    add(options);

    for (const auto& [name, value] : options.settings.items()) {
        const bool differs = std::ranges::any_of(
            all, [&](const Configuration& each) { return each.options.settings[name] != value; });
        if (!differs) continue;
        for (Configuration& each : all) each.varied.emplace_back(name, value_of(each.options, name));
    }
    for (Configuration& each : all) each.label = all.size() > 1 ? label_of(each.varied) : "default";
    return all;
}

Result<Configuration> floor_of(const Configuration& configuration, const Options& standard) {
    // Rays neither are cones nor read mips.
    std::vector<SettingValue> values{{"gather", "floor"}};
    for (const char* name : {"cones", "apertures", "rotate-cones", "mips", "rays"})
        values.emplace_back(name, value_of(standard, name));
    return with_settings(configuration.options, values).map([](Options options) {
        return Configuration{.options = std::move(options), .label = "floor"};
    });
}

}  // namespace lumo::program
