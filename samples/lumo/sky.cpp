#include "samples/lumo/sky.hpp"

#include "samples/lumo/open_devices.hpp"
#include "samples/lumo/progress.hpp"
#include "techniques/atmosphere/stored.hpp"
#include "techniques/sky/sky.hpp"

namespace lumo::program {

using TablesOfSky = std::shared_ptr<const std::vector<atmosphere::Tables>>;

Result<TablesOfSky> sky_tables(rhi::Device& device, const scene::Scene& scene, const Options& options) {
    if (!scene.sky) return {};
    constexpr int steps = 100;
    Progress progress(steps, options.quiet);
    int shown = 0;
    return atmosphere::stored_or_precomputed_by_fours(device, scene.sky->atmosphere, options.frame.sky.tables,
                                                      rhi::DiskCache::of_user(),
                                                      [&](double done) {
                                                          for (; shown < int(done * steps); ++shown)
                                                              progress.next("the sky's tables");
                                                      })
        .map([](std::vector<atmosphere::Tables> tables) {
            return std::make_shared<const std::vector<atmosphere::Tables>>(std::move(tables));
        });
}

Result<void> add_sky_map(scene::Scene& scene, const Options& options) {
    if (!scene.sky) return {};
    Options first = options;
    first.api = ApiChoice::first;
    int failures = 0;
    auto devices = open_devices(first, failures);
    if (!devices) return tl::unexpected(devices.error());
    rhi::Device& device = devices->front();
    const auto tables = sky_tables(device, scene, options);
    if (!tables) return tl::unexpected(tables.error());

    constexpr uint32_t map_side = 512, rows = 256;
    sky::Settings settings = options.frame.sky;
    settings.map_side = map_side;
    settings.made = *tables;
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
