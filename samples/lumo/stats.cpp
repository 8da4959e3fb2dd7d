#include "samples/lumo/stats.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "scene/printable.hpp"

namespace lumo::program {

nlohmann::ordered_json stats_of(const rhi::DeviceInfo& device, const frame::Rendered& rendered,
                                const nlohmann::ordered_json& settings) {
    using Json = nlohmann::ordered_json;
    Json passes = Json::array();
    for (const rhi::PassTime& pass : rendered.passes)
        passes.push_back({{"name", pass.name}, {"gpu_ms", pass.milliseconds}});
    Json memory = Json::array();
    for (const rhi::MemoryEntry& entry : rendered.memory)
        memory.push_back({{"name", entry.name}, {"bytes", entry.bytes}});
    Json left_out = Json::array();
    for (const frame::PlanItem& item : rendered.plan.items) {
        if (!item.needed) left_out.push_back({{"what", item.what}, {"why", item.why}});
    }
    return {
        {"api", to_string(device.api)},
        {"device", device.name},
        {"driver", device.driver},
        {"settings", settings},
        {"passes", passes},
        {"memory", memory},
        {"left_out", left_out},
        {"wall_ms", rendered.wall_ms},
        {"timing_mode", device.timing == rhi::Timing::overlapped ? "overlapped" : "serialised"},
        {"range", voxels::to_string(rendered.range)},
        {"dropped_voxel_writes", rendered.dropped_voxel_writes},
    };
}

Result<void> write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
    std::ofstream stream(file, std::ios::binary);
    stream << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    stream.close();
    if (!stream)
        return fail(ErrorKind::io, scene::printable(file.string()), "cannot be written",
                    "check that its folder exists and may be written to");
    return {};
}

}  // namespace lumo::program
