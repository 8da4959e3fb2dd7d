// Precomputed tables that outlive the program.
#pragma once

#include "rhi/disk_cache.hpp"
#include "techniques/atmosphere/atmosphere.hpp"

namespace lumo::atmosphere {

/// From the cache where that has what this device makes of this atmosphere; else precomputed, and put there. What
/// cannot be put there is made all the same. `progress` as precompute's; not called for what was stored. Errors: those
/// of Tables::create, and of the device.
Result<Tables> stored_or_precomputed(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                     const Settings& settings, const rhi::DiskCache& cache,
                                     const std::function<void(double)>& progress = {});

/// The same of an atmosphere of any number of wavelengths: tables for each part of by_fours; `progress` is told the part
/// done of all.
Result<std::vector<Tables>> stored_or_precomputed_by_fours(rhi::Device& device,
                                                           const scene::Atmosphere& atmosphere,
                                                           const Settings& settings,
                                                           const rhi::DiskCache& cache,
                                                           const std::function<void(double)>& progress = {});

}  // namespace lumo::atmosphere
