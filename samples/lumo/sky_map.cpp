#include "samples/lumo/sky_map.hpp"

#include "samples/lumo/open_devices.hpp"
#include "techniques/sky/sky.hpp"

namespace lumo::program {

Result<void> add_sky_map(scene::Scene& scene, const Options& options) {
    if (!scene.sky) return {};
    Options first = options;
    first.api = ApiChoice::first;
    int failures = 0;
    auto devices = open_devices(first, failures);
    if (!devices) return tl::unexpected(devices.error());
    rhi::Device& device = devices->front();

    constexpr uint32_t map_side = 512, rows = 256;
    sky::Settings settings = options.frame.sky;
    settings.map_side = map_side;
    auto sky = sky::Sky::create(device, scene.sky->atmosphere, settings);
    if (!sky) return tl::unexpected(sky.error());
    rhi::Commands commands = device.begin();
    sky->record_map(commands, *scene.sky);
    if (const Result<void> done = device.wait(device.submit(std::move(commands))); !done) return done;
    return download_map(device, *sky, rows).map([&](scene::ImageF map) {
        scene.environment_map = std::move(map);
    });
}

}  // namespace lumo::program
