// One picture of one scene: load, plan, one frame, read back.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "scene/image.hpp"
#include "scene/scene.hpp"
#include "techniques/frame/plan.hpp"
#include "techniques/frame/settings.hpp"

namespace lumo::frame {

/// One layer of a frame, row 0 at the top: `display` for Layer::final (RGBA), `linear` for the others (RGB; depth has
/// one channel).
struct LayerImage {
    Layer layer = Layer::final;
    scene::Image8 display;
    scene::ImageF linear;
};

struct Rendered {
    std::vector<LayerImage> layers;  ///< in the order of Settings::layers
    Plan plan;
    std::vector<rhi::PassTime> passes;
    std::vector<rhi::MemoryEntry> memory;
    double wall_ms = 0;  ///< of recording and running the frame; loading and compiling are not in it
    voxels::Range range = voxels::Range::ldr;  ///< of the voxels, as the settings or the scene chose it
    uint32_t dropped_voxel_writes = 0;         ///< by voxels::Range mutex or average; the others drop none
    std::string trace;  ///< the frame's barriers, as rhi::Device::trace, where tracing is on
};

/// Renders with resolve()d settings, and of the scene's lights those that shadow::drawn_lights returns. Errors: those of
/// the device and of the techniques.
Result<Rendered> render(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera,
                        const Settings& asked);

/// Told the times of the frame that was just rendered; whether it is to be rendered again.
using Again = std::function<bool(const std::vector<rhi::PassTime>&)>;

/// The same of a scene that is on the device already, with Settings::diffuse_materials as asked, for as long as `again`
/// says so; what is returned is of the last frame.
Result<Rendered> render(rhi::Device& device, const scene::Scene& scene, const scene::GpuScene& gpu_scene,
                        const scene::Camera& camera, const Settings& asked, const Again& again);

}  // namespace lumo::frame
