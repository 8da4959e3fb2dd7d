// Figures of a run as JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "rhi/device_info.hpp"
#include "rhi/error.hpp"
#include "techniques/frame/render.hpp"

namespace lumo::program {

/// One frame: api, device, driver, settings, passes, memory, left_out, wall_ms, timing_mode, range,
/// dropped_voxel_writes.
nlohmann::ordered_json stats_of(const rhi::DeviceInfo& device, const frame::Rendered& rendered,
                                const nlohmann::ordered_json& settings);

/// Errors: io.
Result<void> write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace lumo::program
