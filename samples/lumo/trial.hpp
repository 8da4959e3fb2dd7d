// One configuration of a scene, measured: what a frame of it takes on a device, and how far its light is from the truth.
//
//     auto truth = truth_of(scene, camera, settings, {.spp = 256, .bounces = settings.bounces});
//     auto device = TrialDevice::create(rhi::Api::vulkan, options, scene, camera);
//     auto trial = device->run(settings);
//     auto errors = errors_against(*truth, trial->layers);
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/path_tracer.hpp"
#include "rhi/rhi.hpp"
#include "samples/lumo/options.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/frame/render.hpp"

namespace lumo::program {

/// How often a frame is rendered after one that warms up: until the median of its GPU time is as stable as asked, but
/// no more where so many seconds have passed.
struct RunLimits {
    uint32_t least = 3;
    uint32_t most = 15;
    double seconds = 4;
    double precision = 0.02;  ///< standard error of the median over the median
};

/// A pass, or all of a frame's passes of that name.
struct PassCost {
    std::string name;
    double gpu_ms = 0;  ///< median over the runs
};

struct Trial {
    std::vector<PassCost> passes = {};  ///< in the frame's order
    double gpu_ms = 0;                  ///< median of a frame's sum
    double gpu_ms_error = 0;            ///< standard error of that median
    uint32_t runs = 0;
    frame::Rendered frame = {};                  ///< the last one that was timed: plan, memory, range
    std::vector<frame::LayerImage> layers = {};  ///< of Settings::layers

    uint64_t bytes() const;  ///< device memory of all resources, the scene's included
};

/// An error that says of a configuration that it does not fit the device, which is usable as before.
bool does_not_fit(const Error& error);

/// A scene on a device, from one camera.
class TrialDevice {
  public:
    /// The scene outlives it. Errors: those of create_device and GpuScene::create.
    static Result<TrialDevice> create(rhi::Api api, const Options& options, const scene::Scene& scene,
                                      const scene::Camera& camera);

    /// With Settings::diffuse_materials of the options. What is timed is the frame as a display gets it; the layers are
    /// another frame's. Errors: those of frame::render, of which limit and out_of_memory say that the configuration does
    /// not fit and leave the device usable; unsupported where a message of the API's own checks fails the run.
    Result<Trial> run(const frame::Settings& settings, const RunLimits& limits = {});
    /// The layers alone, once.
    Result<std::vector<frame::LayerImage>> draw(const frame::Settings& settings);

    const rhi::DeviceInfo& info() const { return device_.info(); }

  private:
    Result<frame::Rendered> render(const frame::Settings& settings, const frame::Again& again);

    TrialDevice(rhi::Device device, scene::GpuScene gpu_scene, const scene::Scene& scene,
                const scene::Camera& camera, std::shared_ptr<int> failures);

    std::shared_ptr<int> failures_;  ///< messages that fail a run; shared with the device's sink
    rhi::Device device_;
    scene::GpuScene gpu_scene_;
    const scene::Scene* scene_;
    scene::Camera camera_;
};

/// What the truth is traced with, beside the frame's settings.
struct TruthSettings {
    uint32_t spp = 256;
    std::optional<uint32_t> bounces = 1;  ///< none: all
    uint32_t seed = 1;                    ///< another one has other noise
};

/// The frame's layers of light by the path tracer, and emission, at pixel centres as frames are; from the cache where it
/// was traced before. Errors: those of path_trace; invalid_argument where none of the layers is the path tracer's.
Result<reference::PathTraced> truth_of(const scene::Scene& scene, const scene::Camera& camera,
                                       const frame::Settings& settings, const TruthSettings& truth,
                                       const reference::Progress& progress = {});

/// The figures of DESIGN.md section 6, of pixels where neither an emitter nor the sky is seen.
struct LayerError {
    frame::Layer layer = frame::Layer::irradiance;
    double relative_rmse = 0;
    double bias = 0;
    double percentile95 = 0;
    double flip_mean = 0;
};

/// Of those layers that the truth has. Errors: those of reference::compare.
Result<std::vector<LayerError>> errors_against(const reference::PathTraced& truth,
                                               const std::vector<frame::LayerImage>& layers);

}  // namespace lumo::program
