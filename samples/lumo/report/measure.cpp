#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <spdlog/spdlog.h>

#include "reference/metrics.hpp"
#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/input.hpp"
#include "samples/lumo/progress.hpp"
#include "samples/lumo/report/error_map.hpp"
#include "samples/lumo/report/findings.hpp"
#include "samples/lumo/report/pareto.hpp"
#include "samples/lumo/sky.hpp"
#include "scene/content_key.hpp"
#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Bounces = std::optional<uint32_t>;  // none: all

std::string hex(const rhi::CacheKey& key) { return fmt::format("{:016x}{:016x}", key.high, key.low); }

/// Names the program by its content: one that was built anew measures anew.
Result<std::string> program_key() {
    return scene::read_file("/proc/self/exe").map([](const std::vector<std::byte>& bytes) {
        return hex(rhi::KeyBuilder().add(bytes).key());
    });
}

/// What is left of the work, in steps, and for how long.
class Schedule {
  public:
    Schedule(size_t steps, bool quiet) : left_(steps), progress_(int(steps), quiet) {}

    /// The step before is done, and this one begins.
    void next(const std::string& what) {
        progress_.next(timed_ == 0 ? what
                                   : fmt::format("{}, {} left", what, duration(seconds_ / timed_ * left_)));
        if (left_ > 0) --left_;
    }
    /// The step took so long; those that take next to nothing are not told.
    void took(double seconds) {
        seconds_ += seconds;
        ++timed_;
    }

  private:
    static std::string duration(double seconds) {
        return seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
    }

    double left_;
    double seconds_ = 0;
    int timed_ = 0;
    Progress progress_;
};

/// Those of the sky's tables that take no longer than the frame's.
std::vector<std::string> sky_presets(const Options& options) {
    const std::string last = options.settings.value("preset", "default");
    std::vector<std::string> presets;
    for (const char* preset : {"fast", "default", "precise"}) {
        presets.emplace_back(preset);
        if (preset == last) break;
    }
    return presets;
}

double seconds_of(auto&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Work {
  public:
    Work(const Options& options, Findings& findings, const scene::Scene& scene, const scene::Camera& camera,
         MeasurementLog& log, Schedule& schedule)
        : options_(options),
          findings_(findings),
          scene_(scene),
          camera_(camera),
          log_(log),
          schedule_(schedule) {
        const rhi::CacheKey scene_key = content_key(scene), camera_key = content_key(camera);
        inputs_ = fmt::format("{} {}", hex(scene_key), hex(camera_key));
    }

    /// The references of every number of bounces, and of all.
    Result<void> trace() {
        for (const Configuration& configuration : findings_.configurations) {
            if (Result<void> done = trace(configuration.options.frame.bounces); !done) return done;
        }
        return trace(std::nullopt);
    }

    Result<void> measure(rhi::Api api) {
        auto device = TrialDevice::create(api, options_, scene_, camera_);
        if (!device) return tl::unexpected(device.error());
        DeviceFindings& found = findings_.devices.emplace_back(DeviceFindings{.info = device->info()});
        spdlog::info("{} on {}, {}", to_string(api), scene::printable(found.info.name),
                     scene::printable(found.info.driver));
        for (size_t i = 0; i < findings_.configurations.size(); ++i) {
            auto measured = measure(*device, findings_.configurations[i]);
            if (!measured) return tl::unexpected(measured.error());
            found.rows.push_back({.configuration = i, .measured = std::move(*measured)});
        }
        auto whole = with_settings(findings_.standard().options, {{"plan", "full"}});
        if (!whole) return tl::unexpected(whole.error());
        auto full = measure(*device, {.options = std::move(*whole), .label = "nothing left out"});
        if (!full) return tl::unexpected(full.error());
        found.full_plan = std::move(*full);
        if (Result<void> done = add_floors(*device, found); !done) return done;
        mark_front(found);
        if (Result<void> done = findings_.devices.size() == 1 ? add_panels(*device, found) : Result<void>{};
            !done)
            return done;
        return scene_.sky ? add_sky(api, found) : Result<void>{};
    }

  private:
    Result<void> trace(Bounces bounces) {
        if (truths_.contains(bounces)) return {};
        schedule_.next(bounces ? fmt::format("reference, --bounces {}", *bounces) : "reference, all bounces");
        auto truth = truth_of(scene_, camera_, options_.frame, {.spp = options_.spp, .bounces = bounces});
        if (!truth) return tl::unexpected(truth.error());
        const auto layer = reference::traced_layer_from_string(to_string(findings_.layer));
        findings_.truths.push_back({bounces, (*truth)[*layer].relative_noise});
        truths_.emplace(bounces, std::move(*truth));
        return {};
    }

    std::string key_of(const rhi::DeviceInfo& info, const Configuration& configuration) const {
        rhi::KeyBuilder key;
        key.add(inputs_).add(technique_settings(configuration.options).dump());
        key.add(options_.frame.size.width)
            .add(options_.frame.size.height)
            .add(options_.spp)
            .add(options_.runs);
        for (const frame::Layer layer : options_.frame.layers) key.add(to_string(layer));
        key.add(uint64_t(options_.frame.diffuse_materials)).add(uint64_t(options_.validation));
        key.add(to_string(info.api)).add(info.name).add(info.driver);
        return hex(key.key());
    }

    /// From the log, or now.
    Result<Measurement> measure(TrialDevice& device, const Configuration& configuration) {
        const std::string key = key_of(device.info(), configuration);
        schedule_.next(fmt::format("{} {}", to_string(device.info().api), configuration.label));
        if (auto known = log_.find_measurement(key)) return *known;

        Measurement measured{.key = key, .api = std::string(to_string(device.info().api))};
        Result<void> done;
        const double seconds = seconds_of([&] { done = measure(device, configuration, measured); });
        schedule_.took(seconds);
        if (!done && !does_not_fit(done.error())) return tl::unexpected(done.error());
        if (!done) measured.does_not_fit = to_string(done.error());
        if (Result<void> kept = log_.add(measured); !kept) return tl::unexpected(kept.error());
        return measured;
    }

    Result<void> measure(TrialDevice& device, const Configuration& configuration, Measurement& measured) {
        const auto trial = device.run(configuration.options.frame, {.most = options_.runs});
        if (!trial) return tl::unexpected(trial.error());
        const auto errors = errors_against(truths_.at(configuration.options.frame.bounces), trial->layers);
        const auto of_all = errors_against(truths_.at(std::nullopt), trial->layers);
        if (!errors) return tl::unexpected(errors.error());
        if (!of_all) return tl::unexpected(of_all.error());
        measured.runs = trial->runs;
        measured.gpu_ms = trial->gpu_ms;
        measured.gpu_ms_error = trial->gpu_ms_error;
        measured.bytes = trial->bytes();
        measured.passes = trial->passes;
        // Devices count nanoseconds.
        for (PassCost& pass : measured.passes) pass.gpu_ms = std::round(pass.gpu_ms * 1e6) / 1e6;
        measured.memory = trial->frame.memory;
        for (const frame::PlanItem& item : trial->frame.plan.items)
            if (!item.needed) measured.left_out.push_back({item.what, item.why});
        measured.errors = *errors;
        measured.errors_all_bounces = *of_all;
        return {};
    }

    /// Rays find the same on every device: they are sent on the first.
    Result<void> add_floors(TrialDevice& device, DeviceFindings& found) {
        for (Row& row : found.rows) {
            const Configuration& configuration = findings_.configurations[row.configuration];
            auto rays = floor_of(configuration, options_);
            if (!rays) return tl::unexpected(rays.error());
            const std::string settings = technique_settings(rays->options).dump();
            if (!floors_.contains(settings)) {
                schedule_.next("floor of " + configuration.label);
                auto floor = floor_error(device, *rays);
                if (!floor) return tl::unexpected(floor.error());
                floors_.emplace(settings, *floor);
            }
            row.floor = floors_.at(settings);
        }
        return {};
    }

    Result<std::optional<double>> floor_error(TrialDevice& device, const Configuration& rays) {
        const std::string key = key_of(device.info(), rays);
        auto known = log_.find_measurement(key);
        if (!known) {
            Measurement measured{.key = key, .api = std::string(to_string(device.info().api))};
            Result<std::vector<LayerError>> errors;
            schedule_.took(seconds_of([&] {
                errors = device.draw(rays.options.frame).and_then([&](const auto& layers) {
                    return errors_against(truths_.at(rays.options.frame.bounces), layers);
                });
            }));
            if (!errors && !does_not_fit(errors.error())) return tl::unexpected(errors.error());
            if (errors)
                measured.errors = *errors;
            else
                measured.does_not_fit = to_string(errors.error());
            if (Result<void> kept = log_.add(measured); !kept) return tl::unexpected(kept.error());
            known = std::move(measured);
        }
        const LayerError* error = error_of(known->errors, findings_.layer);
        return error ? std::optional(error->relative_rmse) : std::nullopt;
    }

    void mark_front(DeviceFindings& found) const {
        std::vector<Tradeoff> choices;
        for (const Row& row : found.rows) {
            const LayerError* error = error_of(row.measured.errors, findings_.layer);
            const double none = std::numeric_limits<double>::infinity();
            choices.push_back({error ? row.measured.gpu_ms : none, error ? error->relative_rmse : none});
        }
        for (const size_t i : pareto_front(choices)) found.rows[i].on_front = true;
        for (size_t i = 0; i < choices.size(); ++i) found.rows[i].above_front = above_front(choices, i);
    }

    /// What the sky's tables cost by preset, and how far they are from the reference, on a device of their own.
    Result<void> add_sky(rhi::Api api, DeviceFindings& found) {
        const std::vector<atmosphere::Question> questions = sky_questions(*scene_.sky);
        auto device = bench_device(api, options_);
        if (!device) return tl::unexpected(device.error());
        for (const std::string& preset : sky_presets(options_)) {
            schedule_.next(fmt::format("{} sky, {}", to_string(api), preset));
            const rhi::DeviceInfo& info = device->info();
            rhi::KeyBuilder key;
            key.add("sky").add(inputs_).add(preset).add(to_string(info.api)).add(info.name).add(info.driver);
            const std::string name = hex(key.key());
            const nlohmann::ordered_json* known = log_.find(name);
            auto figures = known ? sky_figures_of(*known) : std::nullopt;
            if (!figures) {
                Result<SkyFigures> measured;
                schedule_.took(seconds_of([&] {
                    measured =
                        measure_sky(*device, *scene_.sky, preset, questions, known_sky_truth(questions));
                }));
                if (!measured) return tl::unexpected(measured.error());
                if (Result<void> kept = log_.add(name, to_json(*measured)); !kept) return kept;
                figures = std::move(*measured);
            }
            found.sky.push_back(std::move(*figures));
        }
        return {};
    }

    /// Sampled once.
    const std::vector<SkyAnswer>& known_sky_truth(std::span<const atmosphere::Question> questions) {
        if (sky_truth_.empty()) sky_truth_ = sky_truth_of(*scene_.sky, questions);
        return sky_truth_;
    }

    /// The reference, the standard configuration, and both ends of the front.
    Result<void> add_panels(TrialDevice& device, const DeviceFindings& found) {
        schedule_.next("pictures");
        const reference::PathTraced& truth = truths_.at(findings_.standard().options.frame.bounces);
        const auto keep = reference::mask_of_reflectors(truth[reference::TracedLayer::emission].mean);
        const auto layer = *reference::traced_layer_from_string(to_string(findings_.layer));
        const scene::ImageF& true_layer = truth[layer].mean;
        const scene::ImageF& true_radiance = truth[reference::TracedLayer::radiance].mean;
        if (!keep) return tl::unexpected(keep.error());
        const auto layer_stops = reference::automatic_exposure(true_layer, *keep);
        const auto radiance_stops = reference::automatic_exposure(true_radiance, *keep);
        if (!layer_stops) return tl::unexpected(layer_stops.error());
        if (!radiance_stops) return tl::unexpected(radiance_stops.error());
        findings_.panels.push_back({.title = "reference",
                                    .subtitle = fmt::format("{} samples a pixel", options_.spp),
                                    .layer = displayed(true_layer, *layer_stops),
                                    .radiance = displayed(true_radiance, *radiance_stops)});

        const auto add = [&](const Row& row, const std::string& title) -> Result<void> {
            const Configuration& configuration = findings_.configurations[row.configuration];
            const auto drawn = device.draw(configuration.options.frame);
            if (!drawn) return tl::unexpected(drawn.error());
            const auto image = [&](frame::Layer wanted) -> const scene::ImageF& {
                return std::ranges::find(*drawn, wanted, &frame::LayerImage::layer)->linear;
            };
            const scene::ImageF& against = truths_.at(configuration.options.frame.bounces)[layer].mean;
            auto map = error_map(against, image(findings_.layer), *keep);
            if (!map) return tl::unexpected(map.error());
            findings_.panels.push_back({.title = title,
                                        .subtitle = configuration.label,
                                        .layer = displayed(image(findings_.layer), *layer_stops),
                                        .radiance = displayed(image(frame::Layer::radiance), *radiance_stops),
                                        .error = std::move(*map)});
            return {};
        };
        const Row *fastest = nullptr, *best = nullptr, *standard = nullptr;
        for (const Row& row : found.rows) {
            if (findings_.configurations[row.configuration].standard) standard = &row;
            if (!row.on_front) continue;
            if (!fastest || row.measured.gpu_ms < fastest->measured.gpu_ms) fastest = &row;
            if (!best || row.measured.gpu_ms > best->measured.gpu_ms) best = &row;
        }
        Result<void> done;
        if (standard && standard->measured.does_not_fit.empty()) done = add(*standard, "default");
        if (done && best && best != standard) done = add(*best, "most accurate");
        if (done && fastest && fastest != best && fastest != standard)
            done = add(*fastest, "fastest on the front");
        return done;
    }

    const Options& options_;
    Findings& findings_;
    const scene::Scene& scene_;
    const scene::Camera& camera_;
    MeasurementLog& log_;
    Schedule& schedule_;
    std::string inputs_;
    std::map<Bounces, reference::PathTraced> truths_;
    std::map<std::string, std::optional<double>> floors_;  ///< by settings
    std::vector<SkyAnswer> sky_truth_;
};

/// How many steps measure() takes.
size_t steps_of(const Findings& findings, size_t apis, size_t sky_presets) {
    std::vector<std::string> floors;
    std::vector<uint32_t> bounces;
    for (const Configuration& configuration : findings.configurations) {
        bounces.push_back(configuration.options.frame.bounces);
        if (const auto floor = floor_of(configuration, findings.options))
            floors.push_back(technique_settings(floor->options).dump());
    }
    const auto distinct = [](auto& values) {
        std::ranges::sort(values);
        return size_t(std::unique(values.begin(), values.end()) - values.begin());
    };
    return distinct(bounces) + 1 + distinct(floors) +
           apis * (findings.configurations.size() + 1 + sky_presets) + 1;
}

}  // namespace

const Configuration& Findings::standard() const {
    return *std::ranges::find_if(configurations, &Configuration::standard);
}

const LayerError* error_of(const std::vector<LayerError>& errors, frame::Layer layer) {
    const auto found = std::ranges::find(errors, layer, &LayerError::layer);
    return found == errors.end() ? nullptr : &*found;
}

Result<Findings> measure(const Options& options, const std::filesystem::path& folder) {
    auto program = program_key();
    if (!program) return tl::unexpected(program.error());
    Findings findings{.options = options, .layer = options.frame.layers.front(), .program = *program};
    auto configurations = configurations_of(options);
    if (!configurations) return tl::unexpected(configurations.error());
    findings.configurations = std::move(*configurations);
    const auto apis = bench_apis(options);
    if (!apis) return tl::unexpected(apis.error());
    auto scene = load_scene(options);
    if (!scene) return tl::unexpected(scene.error());
    if (const Result<void> done = add_sky_map(*scene, options); !done) return tl::unexpected(done.error());
    const auto camera = choose_camera(options, *scene);
    if (!camera) return tl::unexpected(camera.error());
    findings.warnings = warnings_of(*scene);
    for (const std::string& line : findings.warnings) spdlog::warn("{}", line);
    auto log = MeasurementLog::open(folder / "measured.jsonl", *program);
    if (!log) return tl::unexpected(log.error());

    const size_t presets = scene->sky ? sky_presets(options).size() : 0;
    Schedule schedule(steps_of(findings, apis->size(), presets), options.quiet);
    Work work(options, findings, *scene, *camera, *log, schedule);
    if (Result<void> done = work.trace(); !done) return tl::unexpected(done.error());
    for (const rhi::Api api : *apis)
        if (Result<void> done = work.measure(api); !done) return tl::unexpected(done.error());
    return findings;
}

}  // namespace lumo::program
