#include "samples/lumo/traced.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

#include "reference/path_tracer.hpp"
#include "techniques/frame/plan.hpp"

namespace lumo::program {
namespace {

/// final is written as the radiance that it shows.
std::optional<reference::TracedLayer> traced_layer(frame::Layer layer) {
    if (layer == frame::Layer::final) return reference::TracedLayer::radiance;
    return reference::traced_layer_from_string(to_string(layer));
}

}  // namespace

Result<void> check_traceable(const Options& options, std::string_view extension) {
    const auto refuse = [](std::string subject, std::string message, std::string remedy) -> Result<void> {
        return fail(ErrorKind::invalid_argument, std::move(subject), std::move(message), std::move(remedy));
    };
    if (extension != ".exr")
        return refuse("--reference", "writes linear light, not display-referred pictures",
                      "give an .exr to -o");
    if (options.api != ApiChoice::first || !options.device.empty())
        return refuse("--reference", "runs on no API and no device", "leave out --api and --device");
    if (!options.frame.gi)
        return refuse("--reference", "knows no light without indirect light", "leave out --gi off");
    for (const frame::Layer layer : options.frame.layers)
        if (!traced_layer(layer))
            return refuse("--layer", fmt::format("the path tracer has no {}", to_string(layer)),
                          "leave it out");
    return {};
}

Result<TracedPicture> trace(const Options& options, const std::vector<std::string>& layer_names,
                            const scene::Scene& scene, const scene::Camera& camera, Progress& progress) {
    reference::PathTracerSettings settings{.width = options.frame.size.width,
                                           .height = options.frame.size.height,
                                           .spp = options.spp,
                                           .bounces = options.frame.bounces,
                                           .diffuse_materials = options.frame.diffuse_materials,
                                           .pixel_centers_only = true,
                                           .ao_radius = frame::ao_radius(scene, options.frame),
                                           .layers = {}};
    for (const frame::Layer layer : options.frame.layers) settings.layers.push_back(*traced_layer(layer));

    int steps = 0;
    const auto begin = std::chrono::steady_clock::now();
    auto traced = reference::path_trace(scene, camera, settings, [&](double part) {
        for (; steps < int(part * trace_steps); ++steps)
            progress.next(fmt::format("reference {:.0f} %", 100 * part));
    });
    if (!traced) return tl::unexpected(std::move(traced.error()));
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;

    TracedPicture result;
    nlohmann::ordered_json noise = nlohmann::ordered_json::object();
    for (size_t i = 0; i < traced->layers.size(); ++i) {
        reference::TracedImage& layer = traced->layers[i];
        if (!layer.noise.values.empty()) noise[std::string(to_string(layer.layer))] = layer.relative_noise;
        result.picture.layers.push_back({.name = layer_names[i], .image = std::move(layer.mean)});
    }
    result.stats = {{"api", "reference"},
                    {"settings", options.settings},
                    {"wall_ms", wall.count()},
                    {"relative_noise", std::move(noise)}};
    return result;
}

}  // namespace lumo::program
