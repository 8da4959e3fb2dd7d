#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/backends.hpp"
#include "samples/lumo/commands.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr std::array apis{rhi::Api::vulkan, rhi::Api::gl};

}  // namespace

Result<int> devices(const Options& options) {
    bool found = false;
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const rhi::Api api : apis) {
        auto& list = json[std::string(to_string(api))] = nlohmann::ordered_json::array();
        if (!options.json) fmt::print("{}\n", to_string(api));
        for (const rhi::DeviceInfo& device : backends::list_devices(api)) {
            found = true;
            const rhi::Limits& limits = device.limits;
            list.push_back({{"name", device.name},
                            {"driver", device.driver},
                            {"api_version", device.api_version},
                            {"software", device.software},
                            {"max_texture_side_2d", limits.max_texture_side_2d},
                            {"max_texture_side_3d", limits.max_texture_side_3d},
                            {"max_storage_bytes", limits.max_storage_bytes}});
            if (options.json) continue;
            fmt::print("  {}{}\n      driver {}, API {}, textures to {}, volumes to {} a side\n",
                       scene::printable(device.name), device.software ? " (software)" : "",
                       scene::printable(device.driver), scene::printable(device.api_version),
                       limits.max_texture_side_2d, limits.max_texture_side_3d);
        }
        if (!options.json && list.empty()) fmt::print("  none\n");
    }
    if (options.json) fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    if (!found)
        return fail(ErrorKind::no_device, "devices", "neither API finds any",
                    "install a driver, as Debian's mesa-vulkan-drivers and libgl1-mesa-dri");
    return exit_done;
}

std::string version_text() {
    std::string text = fmt::format("lumo {} ({}, compiler {})\n", LUMO_VERSION, LUMO_BUILD_TYPE, __VERSION__);
    for (const rhi::Api api : apis) {
        const auto devices = backends::list_devices(api);
        if (devices.empty()) text += fmt::format("{}: no device\n", to_string(api));
        for (const rhi::DeviceInfo& device : devices)
            text += fmt::format("{} {}: {}, {}\n", to_string(api), device.api_version,
                                scene::printable(device.name), scene::printable(device.driver));
    }
    return text;
}

}  // namespace lumo::program
