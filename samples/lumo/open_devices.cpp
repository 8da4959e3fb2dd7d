#include "samples/lumo/open_devices.hpp"

#include <spdlog/spdlog.h>

#include "backends/backends.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

rhi::DeviceDesc device_desc(const Options& options, int& failures) {
    return {
        .name = options.device, .validation = options.validation, .sink = [&](const rhi::Message& message) {
            if (!is_failure(message)) return;
            ++failures;
            spdlog::error("{}: {}", scene::printable(message.id), scene::printable(message.text, 4000));
        }};
}

Result<rhi::Device> open_device(rhi::Api api, const rhi::DeviceDesc& desc) {
    auto device = backends::create_device(api, desc);
    if (device) {
        spdlog::info("{} on {}, {}", to_string(api), scene::printable(device->info().name),
                     scene::printable(device->info().driver));
    }
    return device;
}

/// A device of the first API that has one.
Result<rhi::Device> open_first_device(const rhi::DeviceDesc& desc) {
    auto vulkan = open_device(rhi::Api::vulkan, desc);
    if (vulkan) return vulkan;
    auto gl = open_device(rhi::Api::gl, desc);
    if (!gl) return fail(gl.error().kind, "--api", to_string(vulkan.error()) + "; " + to_string(gl.error()));
    spdlog::warn("not vulkan: {}", to_string(vulkan.error()));
    return gl;
}

}  // namespace

Result<std::vector<rhi::Device>> open_devices(const Options& options, int& failures) {
    const rhi::DeviceDesc desc = device_desc(options, failures);
    std::vector<Result<rhi::Device>> made;
    if (options.api == ApiChoice::first) made.push_back(open_first_device(desc));
    if (options.api == ApiChoice::gl || options.api == ApiChoice::both)
        made.push_back(open_device(rhi::Api::gl, desc));
    if (options.api == ApiChoice::vulkan || options.api == ApiChoice::both)
        made.push_back(open_device(rhi::Api::vulkan, desc));

    std::vector<rhi::Device> devices;
    for (Result<rhi::Device>& device : made) {
        if (!device) return tl::unexpected(device.error());
        devices.push_back(std::move(*device));
    }
    return devices;
}

}  // namespace lumo::program
