// `lumo bench atmosphere`: what the sky's tables cost, and how far the sky is from the truth.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/probe_sky.hpp"
#include "samples/lumo/values.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;
using atmosphere::Question;
using atmosphere::Settings;

struct Configuration {
    std::string name;
    Settings settings;
};

/// The presets, and the standard one with one table of another size.
std::vector<Configuration> configurations() {
    const Settings standard = settings_of(atmosphere::Preset::standard);
    std::vector<Configuration> all{{"fast", settings_of(atmosphere::Preset::fast)},
                                   {"default", standard},
                                   {"precise", settings_of(atmosphere::Preset::precise)}};
    const auto changed = [&](uint32_t Settings::*member, std::string_view name, uint32_t value) {
        Settings settings = standard;
        settings.*member = value;
        all.push_back({fmt::format("{} {}", name, value), settings});
    };
    changed(&Settings::columns, "columns", standard.columns / 2);
    changed(&Settings::altitudes, "altitudes", standard.altitudes / 2);
    changed(&Settings::suns, "suns", standard.suns / 2);
    changed(&Settings::directions, "directions", standard.directions / 2);
    changed(&Settings::zeniths, "zeniths", standard.zeniths / 2);
    changed(&Settings::azimuths, "azimuths", standard.degree + 1);  // no fewer
    changed(&Settings::table_nodes, "table_nodes", standard.table_nodes / 2);
    changed(&Settings::nodes, "nodes", standard.nodes / 2);
    return all;
}

Json to_json(const Settings& s) {
    return {{"iterations", s.iterations},   {"columns", s.columns},
            {"altitudes", s.altitudes},     {"suns", s.suns},
            {"directions", s.directions},   {"degree", s.degree},
            {"zeniths", s.zeniths},         {"azimuths", s.azimuths},
            {"table_nodes", s.table_nodes}, {"nodes", s.nodes}};
}

/// A row of a file that scripts/atmosphere-truth wrote; its columns are described there.
struct Truth {
    Question question;
    uint32_t orders = 0;
    uint64_t line = 0;
    std::array<double, 3> value = {}, noise = {}, floor = {};
};

Result<std::vector<Truth>> read_truth(const std::filesystem::path& file) {
    const std::string name = scene::printable(file.string());
    const auto table = read_table(file);
    if (!table) return tl::unexpected(table.error());
    const auto questions = read_sky_questions(*table, name);
    if (!questions) return tl::unexpected(questions.error());

    Result<void> read;
    const auto cell = [&](const Table::Row& row, const std::string& column) -> std::string_view {
        const auto place = table->column(column);
        if (read && !place)
            read = fail(ErrorKind::invalid_file, name, fmt::format("has no column {}", column),
                        "give a file that scripts/atmosphere-truth wrote");
        return place ? std::string_view(row.cells[*place]) : "";
    };
    const auto number = [&](const Table::Row& row, const std::string& column) {
        const auto value = parse_number(cell(row, column));
        if (read && !value)
            read =
                fail(ErrorKind::invalid_file, fmt::format("{}, line {}, column {}", name, row.line, column),
                     to_string(value.error()), "give a file that scripts/atmosphere-truth wrote");
        return value.value_or(0);
    };
    std::vector<Truth> all;
    for (size_t r = 0; r < questions->size() && read; ++r) {
        const Table::Row& row = table->rows[r];
        Truth truth{.question = (*questions)[r], .line = row.line};
        truth.orders = parse_orders(cell(row, "orders")).value_or(0);
        if (truth.orders == 0)
            read =
                fail(ErrorKind::invalid_file, fmt::format("{}, line {}, column orders", name, row.line),
                     fmt::format("is '{}'", scene::printable(cell(row, "orders"))), "give 1 to 1000, or all");
        for (size_t i = 0; i < 3; ++i) {
            truth.value[i] = number(row, fmt::format("truth_{}", i));
            truth.floor[i] = number(row, fmt::format("floor_{}", i));
            const std::string noise = fmt::format("noise_{}", i);
            if (!cell(row, noise).empty()) truth.noise[i] = number(row, noise);
        }
        all.push_back(truth);
    }
    if (!read) return tl::unexpected(read.error());
    return all;
}

struct Errors {
    std::string of;  ///< a quantity, and orders where they count
    std::vector<double> error = {}, noise = {};
    uint64_t worst_line = 0;
};

double part_of(std::vector<double> values, double part) {
    const auto place = values.begin() + ptrdiff_t(part * double(values.size() - 1) + 0.5);
    std::ranges::nth_element(values, place);
    return *place;
}

Json to_json(const Errors& e) {
    return {{"quantity", e.of},
            {"rows", e.error.size()},
            {"median", part_of(e.error, 0.5)},
            {"p95", part_of(e.error, 0.95)},
            {"worst", part_of(e.error, 1)},
            {"worst_line", e.worst_line},
            {"noise_median", part_of(e.noise, 0.5)},
            {"noise_worst", part_of(e.noise, 1)}};
}

std::string to_text(const Errors& e) {
    return fmt::format("      {:<26}{:>5} rows{:>10.4f}{:>10.4f}{:>10.4f}   line {:<5}{:>10.4f}{:>10.4f}\n",
                       e.of, e.error.size(), 100 * part_of(e.error, 0.5), 100 * part_of(e.error, 0.95),
                       100 * part_of(e.error, 1), e.worst_line, 100 * part_of(e.noise, 0.5),
                       100 * part_of(e.noise, 1));
}

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// All directions from 1 km up, the sun at 60 degrees.
std::vector<Question> panorama(rhi::Extent size) {
    std::vector<Question> pixels;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x)
            pixels.push_back({.altitude_km = 1,
                              .view_zenith_deg = 180 * (y + 0.5) / size.height,
                              .sun_zenith_deg = 60,
                              .azimuth_deg = 360 * (x + 0.5) / size.width,
                              .quantity = atmosphere::Quantity::radiance});
    return pixels;
}

class AtmosphereBench {
  public:
    AtmosphereBench(const Options& options, std::vector<Truth> truth, rhi::Device& device,
                    const atmosphere::Probe& probe)
        : options_(options),
          truth_(std::move(truth)),
          device_(device),
          probe_(probe),
          pixels_(panorama(options.frame.size)) {}

    Result<void> measure(const Configuration& configuration, Json& json, std::string& text) {
        std::vector<double> times, pixel_times;
        const uint32_t runs = options_.given.contains("runs") ? options_.runs : 1;
        std::optional<atmosphere::Tables> kept;
        for (uint32_t run = 0; run < runs; ++run) {
            const auto begin = std::chrono::steady_clock::now();
            auto tables = precomputed(configuration.settings);
            if (!tables) return tl::unexpected(tables.error());
            times.push_back(milliseconds_since(begin));
            // Drivers compile at the first use.
            if (const auto first = probe_.ask(device_, *tables, {pixels_.data(), 1}); !first)
                return tl::unexpected(first.error());
            const auto rendering = std::chrono::steady_clock::now();
            if (const auto sky = probe_.ask(device_, *tables, pixels_); !sky)
                return tl::unexpected(sky.error());
            pixel_times.push_back(1e6 * milliseconds_since(rendering) / double(pixels_.size()));
            kept = std::move(*tables);
        }
        const uint64_t bytes = kept->bytes();
        const Spread time = spread_of(times), pixel = spread_of(pixel_times);
        json = {{"name", configuration.name},
                {"settings", to_json(configuration.settings)},
                {"precomputation_ms", program::to_json(time)},
                {"bytes", bytes},
                {"ns_per_pixel", program::to_json(pixel)},
                {"errors", Json::array()}};
        text += fmt::format("  {}: {} ms to precompute, {:.2f} MiB, {} ns a pixel\n", configuration.name,
                            program::to_text(time, 0), double(bytes) / (1 << 20), program::to_text(pixel, 0));
        const auto errors = measure_errors(*kept);
        if (!errors) return tl::unexpected(errors.error());
        for (const Errors& e : *errors) {
            json["errors"].push_back(to_json(e));
            text += to_text(e);
        }
        return {};
    }

  private:
    Result<atmosphere::Tables> precomputed(const Settings& settings) {
        auto tables = atmosphere::Tables::create(device_, scene::earth(), settings);
        if (!tables) return tables;
        return atmosphere::precompute(device_, *tables).map([&] { return std::move(*tables); });
    }

    /// By tables of all orders, and where the truth counts fewer by others that end there.
    Result<std::vector<Errors>> measure_errors(const atmosphere::Tables& complete) {
        std::vector<Errors> all;
        std::vector<uint32_t> orders;
        for (const Truth& truth : truth_)
            if (std::ranges::find(orders, tables_for(truth)) == orders.end())
                orders.push_back(tables_for(truth));
        for (const uint32_t last : orders) {
            std::optional<atmosphere::Tables> fewer;
            if (last != reference::all_orders) {
                Settings settings = complete.settings();
                settings.orders = last;
                auto made = precomputed(settings);
                if (!made) return tl::unexpected(made.error());
                fewer = std::move(*made);
            }
            std::vector<Question> questions;
            std::vector<const Truth*> truths;
            for (const Truth& truth : truth_) {
                if (tables_for(truth) != last) continue;
                questions.push_back(truth.question);
                truths.push_back(&truth);
            }
            const auto answers = probe_.ask(device_, fewer ? *fewer : complete, questions);
            if (!answers) return tl::unexpected(answers.error());
            for (size_t i = 0; i < questions.size(); ++i) add(all, *truths[i], (*answers)[i]);
        }
        std::ranges::sort(all, {}, &Errors::of);
        return all;
    }

    /// What is of order 1 is in any.
    static uint32_t tables_for(const Truth& truth) {
        return truth.orders == 1 ? reference::all_orders : truth.orders;
    }

    static void add(std::vector<Errors>& all, const Truth& truth,
                    const std::array<float, atmosphere::max_wavelengths>& answer) {
        const std::string_view quantity = sky_quantities[size_t(truth.question.quantity)];
        const std::string of = truth.orders == 1 ? std::string(quantity)
                               : truth.orders == reference::all_orders
                                   ? fmt::format("{}, all orders", quantity)
                                   : fmt::format("{}, {} orders", quantity, truth.orders);
        auto place = std::ranges::find(all, of, &Errors::of);
        if (place == all.end()) place = all.insert(place, {.of = of});
        double error = 0, noise = 0;
        for (size_t w = 0; w < truth.value.size(); ++w) {
            const double scale = std::max(truth.value[w], truth.floor[w]);
            const double off = std::abs(double(answer[w]) - truth.value[w]);
            error = std::max(error, off / scale);
            noise = std::max(noise, truth.noise[w] / scale);
        }
        if (place->error.empty() || error > *std::ranges::max_element(place->error))
            place->worst_line = truth.line;
        place->error.push_back(error);
        place->noise.push_back(noise);
    }

    const Options& options_;
    std::vector<Truth> truth_;
    rhi::Device& device_;
    const atmosphere::Probe& probe_;
    std::vector<Question> pixels_;
};

}  // namespace

Result<BenchReport> bench_atmosphere(const Options& options) {
    std::vector<Truth> truth;
    if (!options.truth.empty()) {
        auto read = read_truth(options.truth);
        if (!read) return tl::unexpected(read.error());
        truth = std::move(*read);
    }
    const auto apis = bench_apis(options);
    if (!apis) return tl::unexpected(apis.error());
    std::vector<Configuration> all = configurations();
    if (options.given.contains("preset"))
        all = {{options.settings["preset"].get<std::string>(), options.frame.sky.tables}};
    Progress progress(int(apis->size() * all.size()), options.quiet);
    BenchReport report{
        .json = {{"benchmark", "atmosphere"}, {"truth", options.truth.string()}, {"apis", Json::array()}},
        .text = fmt::format(
            "Earth's sky at 680, 550 and 440 nm: time to precompute all orders, memory, wall time a pixel of "
            "a panorama of {}x{}.\n{}",
            options.frame.size.width, options.frame.size.height,
            truth.empty() ? "Errors are measured with --truth.\n"
                          : "Errors in %, of the worst wavelength, relative to the greater of truth and "
                            "floor: median, 95th\npercentile, worst with its line of the truth; the truth's "
                            "own standard error: median, worst.\n")};
    for (const rhi::Api api : *apis) {
        auto device = bench_device(api, options);
        if (!device) return tl::unexpected(device.error());
        const auto probe = atmosphere::Probe::create(*device);
        if (!probe) return tl::unexpected(probe.error());
        const rhi::DeviceInfo& info = device->info();
        report.text += fmt::format("\n{} on {}, {}\n", to_string(api), info.name, info.driver);
        Json json{{"api", to_string(api)},
                  {"device", info.name},
                  {"driver", info.driver},
                  {"configurations", Json::array()}};
        AtmosphereBench bench(options, truth, *device, *probe);
        for (const Configuration& configuration : all) {
            progress.next(fmt::format("{} {}", to_string(api), configuration.name));
            Json entry;
            if (const auto done = bench.measure(configuration, entry, report.text); !done)
                return tl::unexpected(done.error());
            json["configurations"].push_back(std::move(entry));
        }
        report.json["apis"].push_back(std::move(json));
    }
    return report;
}

}  // namespace lumo::program
