// lumo tune: the configuration of a scene on a device that keeps a bound on error or time.
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <spdlog/spdlog.h>

#include "samples/lumo/commands.hpp"
#include "samples/lumo/input.hpp"
#include "samples/lumo/names.hpp"
#include "samples/lumo/open_devices.hpp"
#include "samples/lumo/progress.hpp"
#include "samples/lumo/report/pareto.hpp"
#include "samples/lumo/sky.hpp"
#include "samples/lumo/trial.hpp"
#include "samples/lumo/tune/search.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr rhi::Extent standard_size{320, 180};
constexpr uint32_t standard_runs = 9;
constexpr size_t most_trials = 60;

/// A setting that tune is free to choose, and the values that it chooses among.
struct Axis {
    std::string name;
    std::vector<std::string> values;
};

const std::vector<Axis>& all_axes() {
    static const std::vector<Axis> axes{{"voxels", {"32", "64", "128", "256"}},
                                        {"gather", {"cones", "rays"}},
                                        {"cones", {"1", "3", "5", "7", "9", "12", "16", "24", "32"}},
                                        {"mips", {"iso", "ani"}},
                                        {"apertures", {"uniform", "nonuniform"}},
                                        {"rotate-cones", {"off", "on"}},
                                        {"bounces", {"1", "2", "4"}},
                                        {"range", {"auto", "ldr", "rgbe", "fixed"}},
                                        {"storage", {"vt", "svo"}},
                                        {"voxelizer", {"compute", "raster"}}};
    return axes;
}

/// The settings that are free, and the search's space of them.
struct FreeSettings {
    std::vector<Axis> axes;
    SearchSpace space;
};

FreeSettings free_settings(const Options& options) {
    FreeSettings free;
    for (Axis axis : all_axes()) {
        if (options.given.contains(axis.name)) continue;
        const std::string standard = value_of(options, axis.name);
        auto place = std::ranges::find(axis.values, standard);
        if (place == axis.values.end()) place = axis.values.insert(axis.values.begin(), standard);
        free.space.start.push_back(size_t(place - axis.values.begin()));
        free.space.values.push_back(axis.values.size());
        free.axes.push_back(std::move(axis));
    }
    return free;
}

std::vector<SettingValue> settings_at(const FreeSettings& free, const Place& place) {
    std::vector<SettingValue> values;
    for (size_t i = 0; i < place.size(); ++i)
        values.emplace_back(free.axes[i].name, free.axes[i].values[place[i]]);
    return values;
}

/// The options with what tune takes where they say nothing.
Result<Options> prepared(Options options) {
    const auto refuse = [](std::string subject, std::string message, std::string remedy) {
        return fail(ErrorKind::invalid_argument, std::move(subject), std::move(message), std::move(remedy));
    };
    if (!options.max_error && !options.max_ms)
        return refuse("lumo tune", "there is no bound to keep", "give --max-error or --max-ms");
    if (options.api == ApiChoice::both)
        return refuse("--api both", "a configuration is chosen for one device", "give vulkan or gl");
    if (!options.given.contains("size")) options.frame.size = standard_size;
    options.settings["size"] = fmt::format("{}x{}", options.frame.size.width, options.frame.size.height);
    if (!options.given.contains("runs")) options.runs = standard_runs;
    if (!options.given.contains("layer")) options.frame.layers = {frame::Layer::irradiance};
    if (options.frame.layers.size() != 1)
        return refuse("--layer", "the error is that of one layer", "give one, as irradiance");
    return options;
}

Result<rhi::Api> api_of(const Options& options) {
    if (options.api == ApiChoice::vulkan) return rhi::Api::vulkan;
    if (options.api == ApiChoice::gl) return rhi::Api::gl;
    int failures = 0;
    return open_devices(options, failures).map([](const std::vector<rhi::Device>& devices) {
        return devices.front().info().api;
    });
}

/// The noise of the reference that choices are made by, and of the one that they are held to.
enum Seed : uint32_t { seed_of_search = 1, seed_of_check = 2 };

/// Measures configurations, as a search asks for them.
class Measurer {
  public:
    Measurer(const Options& options, rhi::Api api, const scene::Scene& scene, const scene::Camera& camera,
             const FreeSettings& free, Progress& progress, size_t most)
        : options_(options),
          api_(api),
          scene_(scene),
          camera_(camera),
          free_(free),
          progress_(progress),
          most_(most) {}

    Result<void> open() {
        progress_.next("reference");
        return open(seed_of_search);
    }

    Result<Tradeoff> measure(const Place& place) {
        const double left = done_ > 0 ? seconds() / double(done_) * double(most_ - done_) : 0;
        progress_.next(fmt::format("{} of at most {} trials{}", ++done_, most_,
                                   left > 0 ? fmt::format(", at most {:.0f} s left", left) : ""));
        return run(place);
    }

    /// On a device of its own, against a reference of other noise.
    Result<Tradeoff> again(const Place& place) {
        progress_.next("the choice again");
        if (Result<void> opened = open(seed_of_check); !opened) return tl::unexpected(opened.error());
        const Result<Tradeoff> choice = run(place);
        if (Result<void> opened = open(seed_of_search); !opened) return tl::unexpected(opened.error());
        return choice;
    }

    const rhi::DeviceInfo& info() const { return device_->info(); }

    Result<Options> options_at(const Place& place) const {
        return with_settings(options_, settings_at(free_, place));
    }

  private:
    Result<void> open(Seed seed) {
        if (seed != seed_) {
            std::optional<uint32_t> bounces;
            if (options_.given.contains("bounces")) bounces = options_.frame.bounces;
            auto truth = truth_of(scene_, camera_, options_.frame,
                                  {.spp = options_.spp, .bounces = bounces, .seed = seed});
            if (!truth) return tl::unexpected(truth.error());
            truth_ = std::move(*truth);
            seed_ = seed;
        }
        device_.reset();
        return TrialDevice::create(api_, options_, scene_, camera_).map([&](TrialDevice device) {
            device_.emplace(std::move(device));
        });
    }

    Result<Tradeoff> run(const Place& place) {
        const auto options = options_at(place);
        if (!options) return tl::unexpected(options.error());
        const auto trial = device_->run(options->frame, {.most = options_.runs});
        if (!trial) {
            constexpr double none = std::numeric_limits<double>::infinity();
            if (does_not_fit(trial.error())) return Tradeoff{none, none};
            return tl::unexpected(trial.error());
        }
        const auto errors = errors_against(truth_, trial->layers);
        if (!errors) return tl::unexpected(errors.error());
        // Of the noise of a median twice, so that a time measured again is seldom above it.
        return Tradeoff{trial->gpu_ms + 2 * trial->gpu_ms_error, errors->front().relative_rmse};
    }

    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

    const Options& options_;
    rhi::Api api_;
    const scene::Scene& scene_;
    scene::Camera camera_;
    const FreeSettings& free_;
    Progress& progress_;
    size_t most_;
    size_t done_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    uint32_t seed_ = 0;
    reference::PathTraced truth_;
    std::optional<TrialDevice> device_;
};

/// What renders this configuration; of what only tune knows, nothing.
std::string render_command(const Options& options, rhi::Api api) {
    std::string text = "lumo render " + shell_argument(options.scene);
    text += fmt::format(" --api {} --size {}", to_string(api), value_of(options, "size"));
    return text + given_arguments(options, {"scene", "api", "size", "spp", "runs", "layer"});
}

std::string to_text(const Goal& goal, frame::Layer layer) {
    std::vector<std::string> bounds;
    if (goal.max_error)
        bounds.push_back(fmt::format("a relative RMSE of {} of at most {:.4g} %", to_string(layer),
                                     100 * *goal.max_error));
    if (goal.max_cost) bounds.push_back(fmt::format("at most {:.4g} ms", *goal.max_cost));
    return fmt::format("{}", fmt::join(bounds, ", "));
}

std::string to_text(const Tradeoff& choice) {
    return fmt::format("{:.4g} ms, error {:.4g} %", choice.cost, 100 * choice.error);
}

nlohmann::ordered_json to_json(const Tradeoff& choice) {
    return {{"gpu_ms", choice.cost}, {"relative_rmse", choice.error}};
}

}  // namespace

Result<int> tune(const Options& asked) {
    const auto options = prepared(asked);
    if (!options) return tl::unexpected(options.error());
    auto scene = load_scene(*options);
    if (!scene) return tl::unexpected(scene.error());
    for (const std::string& line : warnings_of(*scene)) spdlog::warn("{}", line);
    if (const Result<void> done = add_sky_map(*scene, *options); !done) return tl::unexpected(done.error());
    const auto camera = choose_camera(*options, *scene);
    if (!camera) return tl::unexpected(camera.error());
    const auto api = api_of(*options);
    if (!api) return tl::unexpected(api.error());

    const FreeSettings free = free_settings(*options);
    const Goal goal{.max_error = options->max_error, .max_cost = options->max_ms};
    const SearchLimits limits{.trials = std::clamp<size_t>(free.space.size() / 5, 1, most_trials)};
    Progress progress(int(limits.trials) + 2, options->quiet);
    Measurer measurer(*options, *api, *scene, *camera, free, progress, limits.trials);
    if (Result<void> opened = measurer.open(); !opened) return tl::unexpected(opened.error());
    const auto found = search(
        free.space, goal, limits, [&](const Place& place) { return measurer.measure(place); },
        [&](const Place& place) { return measurer.again(place); });
    if (!found) return tl::unexpected(found.error());
    progress.clear();

    const auto chosen = measurer.options_at(found->place);
    if (!chosen) return tl::unexpected(chosen.error());
    const rhi::DeviceInfo& info = measurer.info();
    const std::string command = render_command(*chosen, *api);
    if (options->json) {
        nlohmann::ordered_json settings = nlohmann::ordered_json::object();
        for (const auto& [name, value] : settings_at(free, found->place)) settings[name] = value;
        nlohmann::ordered_json json{{"scene", options->scene},
                                    {"api", to_string(info.api)},
                                    {"device", info.name},
                                    {"driver", info.driver},
                                    {"layer", to_string(options->frame.layers.front())},
                                    {"met", found->met},
                                    {"configurations", free.space.size()},
                                    {"trials", found->trials},
                                    {"settings", std::move(settings)},
                                    {"measured", to_json(found->choice)},
                                    {"command", command}};
        if (goal.max_error) json["max_error"] = *goal.max_error;
        if (goal.max_cost) json["max_ms"] = *goal.max_cost;
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        fmt::print("{} on {}, {}: {}\n", to_string(info.api), scene::printable(info.name),
                   scene::printable(info.driver), to_text(goal, options->frame.layers.front()));
        fmt::print("{} of {} configurations were measured\n", found->trials, free.space.size());
        fmt::print("{}: {}\n  {}\n",
                   found->met ? "the best, as measured again with other noise"
                              : "none was found that keeps the bounds; the nearest",
                   to_text(found->choice), scene::printable(command, 4000));
    }
    return found->met ? exit_done : exit_differs;
}

}  // namespace lumo::program
