// `lumo bench rhi`: what lumo costs beside calls straight to the API.
#include <algorithm>
#include <fmt/format.h>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/bench/rhi_work.hpp"
#include "scene/printable.hpp"
#include "shaders/bench_rhi/busy.hpp"
#include "shaders/bench_rhi/busy_picture.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;
using shaders::bench_rhi::busy;
using shaders::bench_rhi::busy_picture;

constexpr uint32_t calls = 2000;  // of one submission
/// A run measures this many submissions of each way in turn, because one may be disturbed.
constexpr int turns = 5;
constexpr double least_wall_ms = 500;                // of the work whose pass times are summed
constexpr double aims[] = {1.2, 1.1};                // by rhi::Api: ratio of CPU times, at most
constexpr double least_sum = 0.95, most_sum = 1.05;  // of pass times over wall, when serialised

struct Pair {
    std::vector<double> lumo, straight, ratio;

    void add(double of_lumo, double of_straight) {
        lumo.push_back(of_lumo);
        straight.push_back(of_straight);
        ratio.push_back(of_lumo / of_straight);
    }
};

using Measurement = Result<double> (RhiWork::*)(uint32_t);

/// CPU microseconds a call; each run the median of several turns, so that what disturbs one does not count.
Result<Pair> measure_calls(RhiWork& lumo, RhiWork& straight, Measurement what, uint32_t runs) {
    Pair pair;
    for (uint32_t run = 0; run < runs; ++run) {
        std::vector<double> mine, theirs;
        for (int turn = 0; turn < turns; ++turn) {
            auto a = (lumo.*what)(calls);
            auto b = (straight.*what)(calls);
            if (!a || !b) return tl::unexpected(a ? b.error() : a.error());
            mine.push_back(*a * 1e6 / calls);
            theirs.push_back(*b * 1e6 / calls);
        }
        pair.add(spread_of(mine).median, spread_of(theirs).median);
    }
    return pair;
}

/// GiB a second.
Result<Pair> measure_transfer(RhiWork& lumo, RhiWork& straight, Transfer what, uint32_t runs) {
    constexpr double gib = double(transfer_bytes) / double(uint64_t{1} << 30);
    Pair pair;
    for (uint32_t run = 0; run <= runs; ++run) {
        auto a = lumo.transfer(what);
        auto b = straight.transfer(what);
        if (!a || !b) return tl::unexpected(a ? b.error() : a.error());
        if (run > 0) pair.add(gib / *a, gib / *b);  // the first touches memory for the first time
    }
    return pair;
}

/// The two ways of giving the device the same work; an error where they do not get the same result.
Result<void> check_equal(RhiWork& lumo, RhiWork& straight, const rhi::DeviceInfo& info) {
    std::vector<std::vector<std::byte>> outcomes;
    for (RhiWork* way : {&lumo, &straight}) {
        for (const Measurement what : {&RhiWork::dispatches, &RhiWork::draws})
            if (auto done = (way->*what)(calls); !done) return tl::unexpected(done.error());
        auto outcome = way->outcome();
        if (!outcome) return tl::unexpected(outcome.error());
        outcomes.push_back(*std::move(outcome));
    }
    if (outcomes[0] == outcomes[1]) return {};
    return fail(ErrorKind::unsupported, info.name, "the same work has two results, with lumo and without");
}

struct PassSum {
    double sum_ms = 0;
    double wall_ms = 0;
};

/// Pass times of compute and raster passes in turn, and the time from opening the submission to its end.
class BusyPasses {
  public:
    static Result<BusyPasses> create(rhi::Device& device) {
        auto compute = device.create_compute_pipeline<busy>();
        auto raster =
            device.create_raster_pipeline<busy_picture>({.color = {{.format = rhi::Format::rgba8_unorm}}});
        auto result = device.create_buffer({.name = "result", .size = items * sizeof(uint32_t)});
        auto target = device.create_texture(
            {.name = "target", .extent = {side, side, 1}, .usage = rhi::TextureUsage::attachment});
        if (!compute) return tl::unexpected(compute.error());
        if (!raster) return tl::unexpected(raster.error());
        if (!result) return tl::unexpected(result.error());
        if (!target) return tl::unexpected(target.error());
        return BusyPasses(device, std::move(*compute), std::move(*raster), std::move(*result),
                          std::move(*target));
    }

    Result<PassSum> run(uint32_t rounds) {
        (void)device_->finished({});
        const double start = wall_seconds();
        rhi::Commands commands = device_->begin();
        for (int i = 0; i < pairs; ++i) {
            rhi::Pass pass = commands.pass("compute");
            for (int dispatch = 0; dispatch < dispatches; ++dispatch)
                pass.dispatch(compute_, {.Result = result_.slice()}, {.rounds = rounds},
                              {items / busy::info().local_size[0]});
            pass.end();
            commands.raster_pass("raster", {.color = {{.view = target_.view()}}})
                .draw(raster_, {}, {.rounds = rounds}, rhi::Draw{.vertices = 3});
        }
        const rhi::Submission submission = device_->submit(std::move(commands));
        if (auto done = device_->wait(submission); !done) return tl::unexpected(done.error());
        PassSum sum{.wall_ms = (wall_seconds() - start) * 1e3};
        for (const rhi::PassTime& time : device_->pass_times(submission)) sum.sum_ms += time.milliseconds;
        return sum;
    }

  private:
    static constexpr uint32_t items = 4096, side = 128;
    static constexpr int pairs = 8, dispatches = 4;

    BusyPasses(rhi::Device& device, rhi::ComputePipeline<busy> compute,
               rhi::RasterPipeline<busy_picture> raster, rhi::Buffer result, rhi::Texture target)
        : device_(&device),
          compute_(std::move(compute)),
          raster_(std::move(raster)),
          result_(std::move(result)),
          target_(std::move(target)) {}

    rhi::Device* device_;
    rhi::ComputePipeline<busy> compute_;
    rhi::RasterPipeline<busy_picture> raster_;
    rhi::Buffer result_;
    rhi::Texture target_;
};

struct Sums {
    std::vector<double> sum_ms, wall_ms, ratio;
};

Result<Sums> measure_pass_times(rhi::Device& device, uint32_t runs) {
    auto passes = BusyPasses::create(device);
    if (!passes) return tl::unexpected(passes.error());
    uint32_t rounds = 1;
    for (;;) {  // as much work as fills the least time with some to spare
        auto sum = passes->run(rounds);
        if (!sum) return tl::unexpected(sum.error());
        if (sum->wall_ms >= least_wall_ms * 1.2) break;
        rounds = uint32_t(rounds * std::clamp(least_wall_ms * 1.4 / sum->wall_ms, 1.1, 16.0)) + 1;
    }
    Sums sums;
    for (uint32_t run = 0; run < runs; ++run) {
        auto sum = passes->run(rounds);
        if (!sum) return tl::unexpected(sum.error());
        sums.sum_ms.push_back(sum->sum_ms);
        sums.wall_ms.push_back(sum->wall_ms);
        sums.ratio.push_back(sum->sum_ms / sum->wall_ms);
    }
    return sums;
}

std::string_view name_of(Transfer what) {
    static constexpr std::string_view names[] = {"upload buffer", "upload texture", "read buffer",
                                                 "read texture"};
    return names[size_t(what)];
}

/// What was found on one API, as it grows.
class ApiReport {
  public:
    explicit ApiReport(const rhi::DeviceInfo& info)
        : api_(info.api),
          json_{{"api", to_string(info.api)}, {"device", info.name},  {"driver", info.driver},
                {"software", info.software},  {"cpu", Json::array()}, {"bandwidth", Json::array()}},
          text_(fmt::format("{}: {}, {}\n  {:<16} {:>23} {:>23} {:>20}\n", to_string(info.api),
                            scene::printable(info.name), scene::printable(info.driver), "", "lumo",
                            "straight", "ratio")) {}

    void add_calls(std::string_view what, const Pair& pair) {
        const Spread ratio = spread_of(pair.ratio);
        const double aim = aims[size_t(api_)];
        json_["cpu"].push_back({{"what", what},
                                {"lumo_us", to_json(spread_of(pair.lumo))},
                                {"straight_us", to_json(spread_of(pair.straight))},
                                {"ratio", to_json(ratio)},
                                {"aim", aim},
                                {"met", ratio.median <= aim}});
        add_line(fmt::format("{}, CPU us", what), pair, fmt::format("aim {}", aim));
    }

    void add_transfer(Transfer what, const Pair& pair) {
        json_["bandwidth"].push_back({{"what", name_of(what)},
                                      {"bytes", transfer_bytes},
                                      {"lumo_gib_per_s", to_json(spread_of(pair.lumo))},
                                      {"straight_gib_per_s", to_json(spread_of(pair.straight))},
                                      {"ratio", to_json(spread_of(pair.ratio))}});
        add_line(fmt::format("{}, GiB/s", name_of(what)), pair, "");
    }

    void add_pass_times(const Sums& sums) {
        const Spread ratio = spread_of(sums.ratio);
        json_["pass_times"] = {{"timing_mode", "serialised"},
                               {"sum_ms", to_json(spread_of(sums.sum_ms))},
                               {"wall_ms", to_json(spread_of(sums.wall_ms))},
                               {"sum_over_wall", to_json(ratio)},
                               {"aim", {least_sum, most_sum}},
                               {"met", ratio.median >= least_sum && ratio.median <= most_sum}};
        text_ += fmt::format("  pass times, serialised: sum {} ms over wall {} ms is {}, aim {} to {}\n",
                             to_text(spread_of(sums.sum_ms), 1), to_text(spread_of(sums.wall_ms), 1),
                             to_text(ratio, 3), least_sum, most_sum);
    }

    const Json& json() const { return json_; }
    const std::string& text() const { return text_; }

  private:
    void add_line(const std::string& what, const Pair& pair, const std::string& aim) {
        text_ += fmt::format("  {:<22} {:>22} {:>22} {:>20} {}", what, to_text(spread_of(pair.lumo), 3),
                             to_text(spread_of(pair.straight), 3), to_text(spread_of(pair.ratio), 2), aim);
        text_.erase(text_.find_last_not_of(' ') + 1);
        text_ += '\n';
    }

    rhi::Api api_;
    Json json_;
    std::string text_;
};

Result<ApiReport> measure(rhi::Api api, const Options& options, Progress& progress) {
    // Overlapped: the CPU does not wait for the device between passes.
    auto device = bench_device(api, options, rhi::Timing::overlapped);
    if (!device) return tl::unexpected(device.error());
    const std::string name(to_string(api));
    ApiReport report(device->info());
    auto lumo = work_through_lumo(*device);
    if (!lumo) return tl::unexpected(lumo.error());
    auto straight = (api == rhi::Api::gl ? work_straight_to_gl : work_straight_to_vulkan)(device->info());
    if (!straight) return tl::unexpected(straight.error());
    if (auto same = check_equal(**lumo, **straight, device->info()); !same)
        return tl::unexpected(same.error());

    progress.next(name + " dispatches");
    auto dispatches = measure_calls(**lumo, **straight, &RhiWork::dispatches, options.runs);
    if (!dispatches) return tl::unexpected(dispatches.error());
    report.add_calls("dispatch", *dispatches);

    progress.next(name + " draws");
    auto draws = measure_calls(**lumo, **straight, &RhiWork::draws, options.runs);
    if (!draws) return tl::unexpected(draws.error());
    report.add_calls("draw", *draws);

    progress.next(name + " transfers");
    for (int i = 0; i < transfer_count; ++i) {
        auto transfers = measure_transfer(**lumo, **straight, Transfer(i), options.runs);
        if (!transfers) return tl::unexpected(transfers.error());
        report.add_transfer(Transfer(i), *transfers);
    }

    progress.next(name + " pass times");
    auto serialised = bench_device(api, options, rhi::Timing::serialised);
    if (!serialised) return tl::unexpected(serialised.error());
    auto sums = measure_pass_times(*serialised, options.runs);
    if (!sums) return tl::unexpected(sums.error());
    report.add_pass_times(*sums);
    return report;
}

}  // namespace

Result<BenchReport> bench_rhi(const Options& options) {
    const auto apis = bench_apis(options);
    if (!apis) return tl::unexpected(apis.error());
    constexpr int steps_of_api = 4;
    Progress progress(int(apis->size()) * steps_of_api, options.quiet);
    BenchReport report{
        .json = {{"benchmark", "rhi"},
                 {"runs", options.runs},
                 {"calls", calls},
                 {"cpu_time", "of the calling thread, from opening a submission to submitting it"},
                 {"apis", Json::array()}},
        .text = {}};
    report.text = fmt::format(
        "CPU time of the calling thread to record and submit {} calls, per call; medians of {} runs "
        "(lowest to highest)\n",
        calls, options.runs);
    for (const rhi::Api api : *apis) {
        const auto found = measure(api, options, progress);
        if (!found) return tl::unexpected(found.error());
        report.json["apis"].push_back(found->json());
        report.text += found->text();
    }
    return report;
}

}  // namespace lumo::program
