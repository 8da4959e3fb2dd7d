// What a device is and what it can do.
#pragma once

#include <cstdint>
#include <string>

#include "rhi/check.hpp"

namespace lumo::rhi {

enum class Api : uint8_t { gl, vulkan };
std::string_view to_string(Api api);

/// How pass times are taken. `overlapped`: stamps alone, passes may overlap. `serialised`: every pass starts
/// after the one before it has ended, so that times add up; slower, and the only honest way on software
/// drivers.
enum class Timing : uint8_t { automatic, overlapped, serialised };

struct Limits {
    uint32_t max_groups[3] = {65535, 65535, 65535};
    uint32_t max_group_size[3] = {1024, 1024, 64};
    uint32_t max_group_invocations = 1024;
    uint32_t max_shared_memory = 32768;  ///< bytes
    uint32_t max_texture_side_2d = 0;
    uint32_t max_texture_side_3d = 0;
    uint32_t max_texture_layers = 0;
    uint64_t max_storage_bytes = 0;    ///< of one storage binding
    uint64_t max_uniform_bytes = 0;    ///< of one uniform binding
    uint32_t storage_alignment = 256;  ///< bytes, of a slice's offset
    uint32_t uniform_alignment = 256;
    uint32_t max_color_targets = 8;
    float max_anisotropy = 1;
    uint32_t max_samples = 1;
};

struct DeviceInfo {
    Api api = Api::gl;
    std::string name;    ///< the device's, as the driver says it
    std::string driver;  ///< driver name and version
    std::string api_version;
    bool software = false;  ///< runs on the CPU
    bool geometry_shader = false;
    bool window = false;                 ///< it was made for a window, where Commands::present shows frames
    bool validation = false;             ///< the layers, or KHR_debug with a debug context, are on
    Timing timing = Timing::serialised;  ///< never automatic
    Limits limits;
};

struct MemoryBudget {
    uint64_t used_bytes = 0;
    uint64_t budget_bytes = 0;
};

/// How to make a device.
struct DeviceDesc {
    std::string name = {};    ///< a substring of the wanted device's name, without case; empty takes the best
    bool validation = false;  ///< the API's own checks; an error when they are not installed
    Timing timing = Timing::automatic;
    bool disk_cache = true;  ///< keep compiled pipelines under $XDG_CACHE_HOME/lumo
    MessageSink sink = {};   ///< gets driver messages and failed checks; none: failures go to stderr
};

}  // namespace lumo::rhi
