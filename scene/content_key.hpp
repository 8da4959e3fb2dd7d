// Names a scene by all that is in it, for caches of what was made of it.
#pragma once

#include "rhi/disk_cache.hpp"
#include "scene/scene.hpp"

namespace lumo::scene {

/// Equal for scenes that look alike under any light and camera: names and warnings do not count, cameras neither.
rhi::CacheKey content_key(const Scene& scene);

/// Of what a camera sees; its name does not count.
rhi::CacheKey content_key(const Camera& camera);

}  // namespace lumo::scene
