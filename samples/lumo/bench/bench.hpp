// What `lumo bench` can measure: a table of names, and what benchmarks share.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rhi/rhi.hpp"
#include "samples/lumo/options.hpp"
#include "samples/lumo/progress.hpp"

namespace lumo::program {

/// What a benchmark found, for programs and for readers.
struct BenchReport {
    nlohmann::ordered_json json;
    std::string text;  ///< a table, lines ended
};

/// Repeats what it measures options.runs times.
using BenchFunction = Result<BenchReport> (*)(const Options& options);

struct Benchmark {
    std::string_view name;
    std::string_view does;
    BenchFunction run;
};

/// All of them. A new one is a function in a file of its own, and a line here.
std::span<const Benchmark> benchmarks();

Result<BenchReport> bench_voxels(const Options& options);
Result<BenchReport> bench_memory(const Options& options);
Result<BenchReport> bench_rhi(const Options& options);
Result<BenchReport> bench_atmosphere(const Options& options);

/// Of repeated measurements.
struct Spread {
    double median = 0;
    double lowest = 0;
    double highest = 0;
};

/// Of at least one value.
Spread spread_of(std::vector<double> values);
nlohmann::ordered_json to_json(const Spread& spread);
/// `median (lowest to highest)`, with this many decimals.
std::string to_text(const Spread& spread, int decimals);

/// The APIs that the options ask for, Vulkan before OpenGL. With neither named these are all that find a
/// device, and what is left out is said.
Result<std::vector<rhi::Api>> bench_apis(const Options& options);

/// A device for one of them. Errors: those of create_device.
Result<rhi::Device> bench_device(rhi::Api api, const Options& options,
                                 rhi::Timing timing = rhi::Timing::automatic);

}  // namespace lumo::program
