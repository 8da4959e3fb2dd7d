#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reference/metrics_report.hpp"
#include "samples/lumo/commands.hpp"
#include "samples/lumo/pictures.hpp"
#include "scene/printable.hpp"

namespace lumo::program {

Result<int> diff(const Options& options) {
    if (!options.output.empty()) {
        if (const Result<void> fine = check_output(options.output); !fine)
            return tl::unexpected(fine.error());
    }
    const auto a = read_picture(options.first);
    if (!a) return tl::unexpected(a.error());
    const auto b = read_picture(options.second);
    if (!b) return tl::unexpected(b.error());
    const std::string subject = fmt::format("{}, {}", scene::printable(options.first.string()),
                                            scene::printable(options.second.string()));
    const auto layers = compare(*a, *b, options.parity, subject);
    if (!layers) return tl::unexpected(layers.error());
    if (!options.output.empty()) {
        if (const Result<void> done = write_difference(options.output, *a, *b); !done)
            return tl::unexpected(done.error());
    }

    const bool passed = std::ranges::all_of(
        *layers, [](const LayerComparison& layer) { return layer.figures.parity.passed; });
    if (options.json) {
        nlohmann::ordered_json json{
            {"a", options.first.string()}, {"b", options.second.string()}, {"passed", passed}};
        for (const LayerComparison& layer : *layers) {
            nlohmann::ordered_json entry{{"layer", layer.layer}};
            entry.update(reference::to_json(layer.figures));
            json["layers"].push_back(std::move(entry));
        }
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        for (const LayerComparison& layer : *layers) {
            if (!layer.layer.empty()) fmt::print("{}\n", scene::printable(layer.layer));
            fmt::print("{}", reference::to_text(layer.figures));
        }
    }
    return passed ? exit_done : exit_differs;
}

}  // namespace lumo::program
