#include "samples/lumo/bench/bench.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "backends/backends.hpp"
#include "samples/lumo/commands.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr std::array table{
    Benchmark{"voxels",
              "the paper's table 1: times to voxelize, inject light and trace cones, by configuration",
              bench_voxels},
    Benchmark{"memory", "the paper's table 2: an octree's size from 32 to 1024 voxels a side", bench_memory},
    Benchmark{"atmosphere",
              "the sky's tables: time, memory and time a pixel by preset and size; errors, with --truth",
              bench_atmosphere},
    Benchmark{"rhi", "CPU time per draw and dispatch against OpenGL and Vulkan alone; bandwidth; pass times",
              bench_rhi},
};

}  // namespace

std::span<const Benchmark> benchmarks() { return table; }

Result<int> bench(const Options& options) {
    const auto found = std::ranges::find(table, options.benchmark, &Benchmark::name);
    return found->run(options).map([&](const BenchReport& report) {
        if (options.json)
            fmt::print("{}\n", report.json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
        else
            fmt::print("{}", report.text);
        return int(exit_done);
    });
}

Spread spread_of(std::vector<double> values) {
    std::ranges::sort(values);
    const size_t middle = values.size() / 2;
    const double median = values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
    return {median, values.front(), values.back()};
}

nlohmann::ordered_json to_json(const Spread& spread) {
    return {{"median", spread.median}, {"min", spread.lowest}, {"max", spread.highest}};
}

std::string to_text(const Spread& spread, int decimals) {
    return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", spread.median, decimals, spread.lowest, decimals,
                       spread.highest, decimals);
}

Result<std::vector<rhi::Api>> bench_apis(const Options& options) {
    switch (options.api) {
        case ApiChoice::vulkan:
            return std::vector{rhi::Api::vulkan};
        case ApiChoice::gl:
            return std::vector{rhi::Api::gl};
        case ApiChoice::both:
            return std::vector{rhi::Api::vulkan, rhi::Api::gl};
        case ApiChoice::first:
            break;
    }
    std::vector<rhi::Api> found;
    for (const rhi::Api api : {rhi::Api::vulkan, rhi::Api::gl}) {
        if (backends::list_devices(api).empty())
            spdlog::warn("{} is left out: it finds no device", to_string(api));
        else
            found.push_back(api);
    }
    if (found.empty())
        return fail(ErrorKind::no_device, "bench", "neither API finds a device",
                    "install a driver, as Debian's mesa-vulkan-drivers and libgl1-mesa-dri");
    return found;
}

Result<rhi::Device> bench_device(rhi::Api api, const Options& options, rhi::Timing timing) {
    return backends::create_device(
        api, {.name = options.device, .timing = timing, .sink = [](const rhi::Message& message) {
                  if (!is_failure(message)) return;
                  spdlog::error("{}: {}", scene::printable(message.id), scene::printable(message.text, 4000));
              }});
}

}  // namespace lumo::program
