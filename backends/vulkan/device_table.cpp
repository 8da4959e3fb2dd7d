#include "backends/vulkan/device_table.hpp"

namespace lumo::backends::vulkan {

DeviceTable load_device_table(PFN_vkGetDeviceProcAddr get, VkDevice device) {
    DeviceTable table;
#define LUMO_LOAD(function) table.function = reinterpret_cast<PFN_##function>(get(device, #function));
    LUMO_VULKAN_DEVICE_FUNCTIONS(LUMO_LOAD)
#undef LUMO_LOAD
    return table;
}

}  // namespace lumo::backends::vulkan
