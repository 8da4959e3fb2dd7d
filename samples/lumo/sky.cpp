#include "samples/lumo/sky.hpp"

#include <vector>

#include "samples/lumo/open_devices.hpp"
#include "samples/lumo/progress.hpp"
#include "techniques/atmosphere/stored.hpp"
#include "techniques/sky/sky.hpp"

namespace lumo::program {

Result<void> prepare_sky(rhi::Device& device, const scene::Scene& scene, const Options& options) {
    if (!scene.sky) return {};
    const std::vector<scene::Atmosphere> parts = atmosphere::by_fours(scene.sky->atmosphere);
    constexpr int steps = 100;
    Progress progress(int(parts.size()) * steps, options.quiet);
    for (const scene::Atmosphere& part : parts) {
        int shown = 0;
        const auto tables = atmosphere::stored_or_precomputed(device, part, options.frame.sky.tables,
                                                              rhi::DiskCache::of_user(), [&](double done) {
                                                                  for (; shown < int(done * steps); ++shown)
                                                                      progress.next("the sky's tables");
                                                              });
        if (!tables) return tl::unexpected(tables.error());
    }
    return {};
}

Result<void> add_sky_map(scene::Scene& scene, const Options& options) {
    if (!scene.sky) return {};
    Options first = options;
    first.api = ApiChoice::first;
    int failures = 0;
    auto devices = open_devices(first, failures);
    if (!devices) return tl::unexpected(devices.error());
    rhi::Device& device = devices->front();
    if (const Result<void> done = prepare_sky(device, scene, options); !done) return done;

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
