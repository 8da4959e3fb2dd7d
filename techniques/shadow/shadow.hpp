// The shadow map of the one directional light.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/shadow/depth.hpp"
#include "shaders/shadow/masked.hpp"
#include "shaders/shadow/position.hpp"

namespace lumo::shadow {

struct Settings {
    uint32_t resolution = 2048;    ///< texels a side, 16 to 16384
    bool position_target = false;  ///< world positions beside the depth, as the paper injects light
};

/// What the scene needs of the map; nothing else is made.
struct Needs {
    bool alpha_mask = false;  ///< some surface is cut out by its texture's alpha
};

/// The light's camera: orthographic, around the bounds as tightly as a box turned to the light can be, plus a
/// margin of two texels for filters. clip x and y span [-1, 1]; depth grows away from the light.
struct LightCamera {
    glm::mat4 clip_from_world{1};
    glm::mat4 world_from_clip{1};
    glm::vec3 direction_to_light{0, 1, 0};  ///< unit length
    glm::vec2 texel_size{0};                ///< metres
};
LightCamera fit_light(const scene::Bounds& bounds, glm::vec3 direction_to_light, uint32_t resolution);

/// The uniform block of shaders/common/shadow_block.glsl, for every program that includes it.
using Block = shaders::shadow::depth::ShadowBlock;

/// What later passes read.
struct View {
    uint32_t resolution = 0;
    LightCamera camera;
    float texel_area = 0;                 ///< of a texel on a plane facing the light, m²
    rhi::View<rhi::Dimension::d2> depth;  ///< 1 where nothing was hit; unbiased
    std::optional<rhi::View<rhi::Dimension::d2>>
        position;              ///< world, rgba32_float; a: 1 where something was hit
    rhi::UniformBuffer block;  ///< a Block, for shaders/common/shadow.glsl
};

class Shadow {
  public:
    /// Errors: those of the device; invalid_argument for a resolution outside its range.
    static Result<Shadow> create(rhi::Device& device, const Settings& settings, const Needs& needs);

    /// Draws all but blended surfaces, both faces of each: light does not pass a surface that is culled for
    /// cameras.
    View record(rhi::Commands& commands, const scene::GeometryView& geometry, glm::vec3 direction_to_light);

    // The targets, to read them back; `position` is empty without Settings::position_target.
    const rhi::Texture& depth() const { return depth_; }
    const rhi::Texture& position() const { return position_; }

  private:
    Settings settings_;
    Needs needs_;
    rhi::Texture depth_;
    rhi::Texture position_;
    rhi::RasterPipeline<shaders::shadow::depth> depth_pipeline_;
    rhi::RasterPipeline<shaders::shadow::masked> masked_pipeline_;
    rhi::RasterPipeline<shaders::shadow::position> position_pipelines_[2];  ///< by alpha test
};

}  // namespace lumo::shadow
