// Path-traced pictures that outlive the program: traced once for a scene, a camera and settings.
#pragma once

#include <cstdint>

#include "reference/path_tracer.hpp"
#include "rhi/disk_cache.hpp"

namespace lumo::reference {

/// Of the sources of this library, so that what an older one has traced is traced again.
uint64_t sources_version();

/// $XDG_CACHE_HOME/lumo/reference, of at most 1 GiB; see rhi::DiskCache::of_user.
rhi::DiskCache user_cache();

struct CachedTrace {
    PathTraced traced;
    bool found = false;        ///< it was in the cache
    Result<void> stored = {};  ///< why the cache does not have it now; a caller may say so and go on
};

/// path_trace(), or what it once returned for the same content. What is damaged is traced again and replaced. Errors:
/// those of path_trace.
Result<CachedTrace> path_trace_cached(const scene::Scene& scene, const scene::Camera& camera,
                                      const PathTracerSettings& settings, const rhi::DiskCache& cache,
                                      const Progress& progress = {});

}  // namespace lumo::reference
