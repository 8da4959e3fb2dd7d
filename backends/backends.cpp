#include "backends/backends.hpp"

#include "backends/gl/gl.hpp"
#include "backends/vulkan/vulkan.hpp"

namespace lumo::backends {

Result<rhi::Device> create_device(rhi::Api api, const rhi::DeviceDesc& desc,
                                  std::shared_ptr<const Surface> surface) {
    auto backend = api == rhi::Api::gl ? gl::create_backend(desc, surface)
                                       : vulkan::create_backend(desc, std::move(surface));
    return std::move(backend).map(
        [&](std::unique_ptr<rhi::Backend> made) { return rhi::Device(std::move(made), desc); });
}

std::vector<rhi::DeviceInfo> list_devices(rhi::Api api) {
    return api == rhi::Api::gl ? gl::list_devices() : vulkan::list_devices();
}

}  // namespace lumo::backends
