#include "samples/lumo/trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <numeric>
#include <spdlog/spdlog.h>

#include "backends/backends.hpp"
#include "reference/cache.hpp"
#include "reference/metrics.hpp"
#include "samples/lumo/bench/bench.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

/// Of the median of normally distributed values, from the median of their distances to it, which a few outliers do not
/// move: 1.4826 makes that a standard deviation, 1.2533 is the median's error over the mean's.
double error_of_median(const std::vector<double>& values, double median) {
    std::vector<double> distances;
    distances.reserve(values.size());
    for (const double value : values) distances.push_back(std::abs(value - median));
    return 1.2533 * 1.4826 * spread_of(std::move(distances)).median / std::sqrt(double(values.size()));
}

/// Times of a frame that is rendered again and again.
class Runs {
  public:
    explicit Runs(const RunLimits& limits) : limits_(limits) {}

    /// Takes a frame's times; whether another one is wanted.
    bool add(const std::vector<rhi::PassTime>& passes) {
        if (!std::exchange(warm_, true)) {
            start_ = std::chrono::steady_clock::now();
            return true;
        }
        std::map<std::string, double> sums;
        for (const rhi::PassTime& pass : passes) {
            if (sums.emplace(pass.name, 0).second && sums_.empty()) order_.push_back(pass.name);
            sums[pass.name] += pass.milliseconds;
        }
        double frame = 0;
        for (const auto& [name, sum] : sums) {
            sums_[name].push_back(sum);
            frame += sum;
        }
        frames_.push_back(frame);
        return wants_more();
    }

    void put(Trial& trial) const {
        for (const std::string& name : order_)
            trial.passes.push_back({.name = name, .gpu_ms = spread_of(sums_.at(name)).median});
        trial.gpu_ms = spread_of(frames_).median;
        trial.gpu_ms_error = error_of_median(frames_, trial.gpu_ms);
        trial.runs = uint32_t(frames_.size());
    }

  private:
    bool wants_more() const {
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
        if (frames_.size() >= limits_.most || passed.count() > limits_.seconds) return false;
        if (frames_.size() < limits_.least) return true;
        const double median = spread_of(frames_).median;
        return error_of_median(frames_, median) > limits_.precision * median;
    }

    RunLimits limits_;
    bool warm_ = false;
    std::chrono::steady_clock::time_point start_;
    std::vector<std::string> order_;
    std::map<std::string, std::vector<double>> sums_;  ///< by pass, a value a frame
    std::vector<double> frames_;
};

std::optional<reference::TracedLayer> traced_light(frame::Layer layer) {
    using enum reference::TracedLayer;
    const auto traced = reference::traced_layer_from_string(to_string(layer));
    constexpr std::array surfaces{albedo, normal, depth};
    return traced && std::ranges::find(surfaces, *traced) == surfaces.end() ? traced : std::nullopt;
}

}  // namespace

bool does_not_fit(const Error& error) {
    return error.kind == ErrorKind::limit || error.kind == ErrorKind::out_of_memory;
}

uint64_t Trial::bytes() const {
    return std::accumulate(frame.memory.begin(), frame.memory.end(), uint64_t(0),
                           [](uint64_t sum, const rhi::MemoryEntry& entry) { return sum + entry.bytes; });
}

TrialDevice::TrialDevice(rhi::Device device, scene::GpuScene gpu_scene, const scene::Scene& scene,
                         const scene::Camera& camera, std::shared_ptr<int> failures)
    : failures_(std::move(failures)),
      device_(std::move(device)),
      gpu_scene_(std::move(gpu_scene)),
      scene_(&scene),
      camera_(camera) {}

Result<TrialDevice> TrialDevice::create(rhi::Api api, const Options& options, const scene::Scene& scene,
                                        const scene::Camera& camera) {
    auto failures = std::make_shared<int>(0);
    auto device = backends::create_device(api, {.name = options.device,
                                                .validation = options.validation,
                                                .sink = [failures](const rhi::Message& message) {
                                                    if (!is_failure(message)) return;
                                                    ++*failures;
                                                    spdlog::error("{}: {}", scene::printable(message.id),
                                                                  scene::printable(message.text, 4000));
                                                }});
    if (!device) return tl::unexpected(device.error());
    auto gpu_scene = scene::GpuScene::create(*device, scene, options.frame.diffuse_materials);
    if (!gpu_scene) return tl::unexpected(gpu_scene.error());
    return TrialDevice(std::move(*device), std::move(*gpu_scene), scene, camera, std::move(failures));
}

Result<frame::Rendered> TrialDevice::render(const frame::Settings& settings, const frame::Again& again) {
    auto frame = frame::render(device_, *scene_, gpu_scene_, camera_, settings, again);
    if (frame && *failures_ > 0)
        return fail(ErrorKind::unsupported, "validation",
                    fmt::format("{} messages that fail a run", *failures_), "they are above");
    return frame;
}

Result<Trial> TrialDevice::run(const frame::Settings& settings, const RunLimits& limits) {
    frame::Settings displayed = settings;
    displayed.layers = {frame::Layer::final};
    Runs runs(limits);
    auto frame =
        render(displayed, [&](const std::vector<rhi::PassTime>& passes) { return runs.add(passes); });
    if (!frame) return tl::unexpected(frame.error());
    auto layers = draw(settings);
    if (!layers) return tl::unexpected(layers.error());
    Trial trial{.frame = std::move(*frame), .layers = std::move(*layers)};
    runs.put(trial);
    return trial;
}

Result<std::vector<frame::LayerImage>> TrialDevice::draw(const frame::Settings& settings) {
    return render(settings, {}).map([](frame::Rendered&& frame) { return std::move(frame.layers); });
}

Result<reference::PathTraced> truth_of(const scene::Scene& scene, const scene::Camera& camera,
                                       const frame::Settings& settings, const TruthSettings& truth,
                                       const reference::Progress& progress) {
    reference::PathTracerSettings tracer{.width = settings.size.width,
                                         .height = settings.size.height,
                                         .spp = truth.spp,
                                         .bounces = truth.bounces,
                                         .seed = truth.seed,
                                         .diffuse_materials = settings.diffuse_materials,
                                         .pixel_centers_only = true,
                                         .ao_radius = frame::ao_radius(scene, settings),
                                         .layers = {}};
    for (const frame::Layer layer : settings.layers)
        if (const auto traced = traced_light(layer)) tracer.layers.push_back(*traced);
    if (tracer.layers.empty())
        return fail(ErrorKind::invalid_argument, "--layer", "the path tracer has none of these",
                    "take irradiance, radiance, direct, indirect or specular");
    if (std::ranges::find(tracer.layers, reference::TracedLayer::emission) == tracer.layers.end())
        tracer.layers.push_back(reference::TracedLayer::emission);
    auto traced = reference::path_trace_cached(scene, camera, tracer, reference::user_cache(), progress);
    if (!traced) return tl::unexpected(std::move(traced.error()));
    if (!traced->stored) spdlog::warn("the reference is not kept: {}", to_string(traced->stored.error()));
    return std::move(traced->traced);
}

Result<std::vector<LayerError>> errors_against(const reference::PathTraced& truth,
                                               const std::vector<frame::LayerImage>& layers) {
    const auto keep = reference::mask_of_reflectors(truth[reference::TracedLayer::emission].mean);
    if (!keep) return tl::unexpected(keep.error());
    std::vector<LayerError> errors;
    for (const frame::LayerImage& image : layers) {
        const auto traced = traced_light(image.layer);
        if (!traced ||
            std::ranges::find(truth.layers, *traced, &reference::TracedImage::layer) == truth.layers.end())
            continue;
        const auto figures =
            reference::compare(truth[*traced].mean, image.linear, {.keep = *keep, .max_misses = 0});
        if (!figures) return tl::unexpected(figures.error());
        errors.push_back({.layer = image.layer,
                          .relative_rmse = figures->relative_rmse,
                          .bias = figures->bias,
                          .percentile95 = figures->percentile95_relative,
                          .flip_mean = figures->flip_mean});
    }
    return errors;
}

}  // namespace lumo::program
