#include "techniques/frame/render.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <vector>

#include "backends/capture.hpp"
#include "reference/metrics_report.hpp"
#include "samples/lumo/commands.hpp"
#include "samples/lumo/input.hpp"
#include "samples/lumo/names.hpp"
#include "samples/lumo/open_devices.hpp"
#include "samples/lumo/pictures.hpp"
#include "samples/lumo/progress.hpp"
#include "samples/lumo/sky.hpp"
#include "samples/lumo/stats.hpp"
#include "samples/lumo/traced.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

/// What is rendered, and into which file.
struct Product {
    std::filesystem::path file;
    frame::Settings settings;
    std::vector<std::string> layer_names = {};  ///< in the file, by Settings::layers
};

Result<Product> product_of(const Options& options) {
    Product product{.file = options.output, .settings = options.frame};
    auto& layers = product.settings.layers;
    const bool displayed = layers == std::vector{frame::Layer::final} && !options.reference;
    if (product.file.empty()) {
        product.file = std::filesystem::path(options.scene).stem();
        product.file += displayed ? ".png" : ".exr";
    }
    if (const Result<void> fine = check_output(product.file); !fine) return tl::unexpected(fine.error());
    if (options.reference) {
        if (const Result<void> fine = check_traceable(options, extension_of(product.file)); !fine)
            return tl::unexpected(fine.error());
    }
    if (extension_of(product.file) == ".png") {
        if (!displayed)
            return fail(ErrorKind::invalid_argument, scene::printable(product.file.string()),
                        "a .png holds the layer final alone", "write linear layers to an .exr");
        product.layer_names.emplace_back();
        return product;
    }
    for (frame::Layer& layer : layers) {
        const bool plain = layers.size() == 1 || layer == frame::Layer::final;
        product.layer_names.emplace_back(plain ? "" : to_string(layer));
        if (layer == frame::Layer::final) layer = frame::Layer::radiance;
    }
    return product;
}

scene::Camera orbited(const scene::Camera& camera, float degrees) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::vec3(0, 1, 0)));
    scene::Camera result = camera;
    result.position = camera.target + turn * (camera.position - camera.target);
    result.up = turn * camera.up;
    return result;
}

/// From one sun to another: along the great circle, at a steady pace.
Sun between(const Sun& from, const Sun& to, float t) {
    const float angle =
        std::acos(std::clamp(glm::dot(from.direction_to_sun, to.direction_to_sun), -1.0f, 1.0f));
    glm::vec3 direction = glm::mix(from.direction_to_sun, to.direction_to_sun, t);
    if (std::sin(angle) > 1e-4f)
        direction =
            (std::sin((1 - t) * angle) * from.direction_to_sun + std::sin(t * angle) * to.direction_to_sun) /
            std::sin(angle);
    return {.direction_to_sun = glm::normalize(direction),
            .irradiance = glm::mix(from.irradiance, to.irradiance, t)};
}

class Renderer {
  public:
    Renderer(const Options& options, Product product, std::vector<rhi::Device>& devices, Progress& progress)
        : options_(options), product_(std::move(product)), devices_(devices), progress_(progress) {}

    /// Before the first frame.
    Result<void> prepare_sky(const scene::Scene& scene) {
        for (rhi::Device& device : devices_) {
            auto tables = sky_tables(device, scene, options_);
            if (!tables) return tl::unexpected(tables.error());
            settings_.push_back(product_.settings);
            settings_.back().sky.made = std::move(*tables);
        }
        return {};
    }

    /// Renders one frame on every device, and writes all that belongs to it; whether the devices agree.
    Result<bool> render(const scene::Scene& scene, const scene::Camera& camera, std::string_view number) {
        std::vector<Picture> pictures;
        for (size_t i = 0; i < devices_.size(); ++i) {
            rhi::Device& device = devices_[i];
            const rhi::DeviceInfo& info = device.info();
            progress_.next(fmt::format("{} {}", to_string(info.api), number));
            const auto rendered =
                capture_once([&] { return frame::render(device, scene, camera, settings_[i]); });
            if (!rendered) return tl::unexpected(rendered.error());
            progress_.clear();
            if (options_.explain && !std::exchange(explained_, true))
                fmt::print("{}", frame::to_text(rendered->plan));

            const std::string_view api = devices_.size() > 1 ? to_string(info.api) : "";
            pictures.push_back(picture_of(rendered->layers, product_.layer_names));
            const std::filesystem::path file = tagged(tagged(product_.file, number), api);
            if (const Result<void> done = write_picture(file, pictures.back()); !done)
                return tl::unexpected(done.error());
            spdlog::info("{}: {:.1f} ms", scene::printable(file.string()), rendered->wall_ms);
            if (options_.stats.empty()) continue;
            if (const Result<void> done = write_json(tagged(tagged(options_.stats, number), api),
                                                     stats_of(info, *rendered, options_.settings));
                !done)
                return tl::unexpected(done.error());
        }
        return pictures.size() < 2 ? Result<bool>(true) : agree(pictures[0], pictures[1], number);
    }

  private:
    /// What `render` returns; the first time, RenderDoc watches where it was asked to.
    template <class Render>
    auto capture_once(Render render) -> decltype(render()) {
        if (options_.capture.empty() || std::exchange(captured_, true)) return render();
        auto capture = backends::Capture::start();
        if (!capture) return tl::unexpected(capture.error());
        auto rendered = render();
        if (!rendered) return rendered;
        if (const Result<void> done = capture->finish(options_.capture); !done)
            return tl::unexpected(done.error());
        spdlog::info("{}", scene::printable(options_.capture.string()));
        return rendered;
    }

    Result<bool> agree(const Picture& gl, const Picture& vulkan, std::string_view number) {
        progress_.next("comparing");
        const std::filesystem::path file = tagged(tagged(product_.file, number), "diff");
        if (const Result<void> done = write_difference(file, gl, vulkan); !done)
            return tl::unexpected(done.error());
        const bool software =
            std::ranges::all_of(devices_, [](const rhi::Device& device) { return device.info().software; });
        const auto layers = compare(gl, vulkan, software ? ParityChoice::mesa : ParityChoice::hardware,
                                    scene::printable(file.string()));
        if (!layers) return tl::unexpected(layers.error());
        progress_.clear();
        bool passed = true;
        for (const LayerComparison& layer : *layers) {
            constexpr size_t listed = 20;
            passed &= layer.figures.parity.passed;
            if (options_.quiet && layer.figures.parity.passed) continue;
            fmt::print("gl (reference) and vulkan (test){}{}\n{}", layer.layer.empty() ? "" : ", ",
                       layer.layer, reference::to_text(layer.figures, listed));
        }
        return passed;
    }

    const Options& options_;
    Product product_;
    std::vector<rhi::Device>& devices_;
    Progress& progress_;
    std::vector<frame::Settings> settings_;  ///< of each device: its tables of the sky
    bool explained_ = false;
    bool captured_ = false;
};

/// Renders one frame, whose number is empty if it is the only one; whether all that drew it agree.
using RenderFrame = std::function<Result<bool>(const scene::Scene&, const scene::Camera&, std::string_view)>;

Result<bool> render_all(const Options& options, scene::Scene& scene, const scene::Camera& camera,
                        const RenderFrame& render_frame) {
    const Animation& animation = options.animation;
    const Sun first_sun = sun_of(scene);
    bool agreed = true;
    for (uint32_t i = animation.shard - 1; i < animation.count; i += animation.shards) {
        const float turn = animation.orbit * float(i) / float(animation.count);
        if (animation.sun_to) {
            const float t = animation.count > 1 ? float(i) / float(animation.count - 1) : 0.0f;
            replace_sun(scene, between(first_sun, *animation.sun_to, t));
        }
        const std::string number = animation.count > 1 ? fmt::format("{:04}", i + 1) : "";
        Result<bool> agrees = render_frame(scene, orbited(camera, turn), number);
        if (!agrees) return agrees;
        agreed &= *agrees;
    }
    return agreed;
}

/// Renders the frames on the devices that the options ask for.
Result<bool> render_on_devices(const Options& options, const Product& product, scene::Scene& scene,
                               const scene::Camera& camera, Progress& progress) {
    int failures = 0;
    Result<bool> agreed = false;
    {
        auto devices = open_devices(options, failures);
        if (!devices) return tl::unexpected(devices.error());
        Renderer renderer(options, product, *devices, progress);
        if (const Result<void> done = renderer.prepare_sky(scene); !done) return tl::unexpected(done.error());
        agreed = render_all(options, scene, camera,
                            [&](const scene::Scene& lit, const scene::Camera& view, std::string_view number) {
                                return renderer.render(lit, view, number);
                            });
    }
    if (agreed && failures > 0)
        return fail(ErrorKind::unsupported, "validation",
                    fmt::format("{} messages that fail a run", failures), "they are above");
    return agreed;
}

/// Traces the frames; without any device, but for a sky.
Result<bool> render_reference(const Options& options, const Product& product, scene::Scene& scene,
                              const scene::Camera& camera, Progress& progress) {
    return render_all(
        options, scene, camera,
        [&](const scene::Scene& lit, const scene::Camera& view, std::string_view number) -> Result<bool> {
            if (const Result<void> done = add_sky_map(scene, options); !done)
                return tl::unexpected(done.error());
            const auto traced = trace(options, product.layer_names, lit, view, progress);
            if (!traced) return tl::unexpected(traced.error());
            const std::filesystem::path file = tagged(product.file, number);
            if (const Result<void> done = write_picture(file, traced->picture); !done)
                return tl::unexpected(done.error());
            spdlog::info("{}: relative noise {}", scene::printable(file.string()),
                         traced->stats["relative_noise"].dump());
            if (!options.stats.empty()) {
                if (const Result<void> done = write_json(tagged(options.stats, number), traced->stats); !done)
                    return tl::unexpected(done.error());
            }
            return true;
        });
}

}  // namespace

Result<int> render(const Options& options) {
    const auto product = product_of(options);
    if (!product) return tl::unexpected(product.error());

    if (!options.capture.empty() && (options.reference || options.api == ApiChoice::both))
        return fail(ErrorKind::invalid_argument, "--capture", "a capture is of one device",
                    "give --api vulkan or --api gl");

    const int apis = options.api == ApiChoice::both ? 2 : 1;
    const int steps = options.reference ? trace_steps : apis + (apis > 1 ? 1 : 0);
    const uint32_t frames =
        (options.animation.count - options.animation.shard) / options.animation.shards + 1;
    Progress progress(1 + int(frames) * steps, options.quiet);
    progress.next(scene::printable(options.scene));
    auto scene = load_scene(options);
    if (!scene) return tl::unexpected(scene.error());
    for (const std::string& line : warnings_of(*scene)) spdlog::warn("{}", line);
    const auto camera = choose_camera(options, *scene);
    if (!camera) return tl::unexpected(camera.error());
    if (options.animation.sun_to && !scene->sky && sun_of(*scene).irradiance == glm::vec3(0))
        return fail(ErrorKind::invalid_argument, "--sun-to", "the scene has no sun to move",
                    "give one with --sun");

    const auto draw = options.reference ? render_reference : render_on_devices;
    const Result<bool> agreed = draw(options, *product, *scene, *camera, progress);
    if (!agreed) return tl::unexpected(agreed.error());
    return *agreed ? exit_done : exit_differs;
}

}  // namespace lumo::program
