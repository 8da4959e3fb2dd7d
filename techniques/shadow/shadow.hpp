// The analytic lights of a frame and their shadow maps.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/lighting/shade.hpp"
#include "shaders/shadow/depth.hpp"
#include "shaders/shadow/masked.hpp"
#include "shaders/shadow/position.hpp"

namespace lumo::shadow {

/// The uniform block of shaders/common/lights.glsl, for every program that includes it.
using Block = shaders::lighting::shade::Lights;

inline constexpr size_t max_lights = std::size(decltype(Block::intensity){});
inline constexpr size_t max_cameras = std::size(decltype(Block::clip_from_world){});

struct Settings {
    uint32_t resolution = 2048;    ///< texels a side, 16 to 16384; fewer where the maps would be too many
    bool position_target = false;  ///< world positions beside the depth, as the paper injects light
};

/// What the scene needs of the maps; nothing else is made.
struct Needs {
    bool alpha_mask = false;  ///< some surface is cut out by its texture's alpha
    uint32_t cameras = 1;     ///< cameras_of all the lights, up to max_cameras
};

/// What a light sees. clip x and y span [-1, 1]; depth grows away from the light.
struct LightCamera {
    glm::mat4 clip_from_world{1};
    glm::mat4 world_from_clip{1};
    glm::vec3 toward_light{0, 1, 0};  ///< against the direction that it looks in, unit length
    glm::vec2 texel_size{0};          ///< metres; in perspective: per metre of depth

    float texel_area() const { return texel_size.x * texel_size.y; }  ///< m²
};

/// Orthographic, around the bounds as tightly as a box turned to the light can be, plus a margin of two texels for
/// filters.
LightCamera fit_light(const scene::Bounds& bounds, glm::vec3 direction_to_light, uint32_t resolution);

/// How many cameras a light needs: 1, or 6 for a point light and for a spot light whose cone is wider than 60 degrees
/// from its axis.
uint32_t camera_count(const scene::Light& light);

/// The lights of a scene that are drawn: those that shine, in their order, as many as max_lights and max_cameras allow.
std::vector<scene::Light> drawn_lights(std::span<const scene::Light> lights);

/// The cameras of a light. A perspective one reaches the farthest corner of the bounds, or the light's range, and
/// begins at a thousandth of that.
std::vector<LightCamera> cameras_of(const scene::Light& light, const scene::Bounds& bounds,
                                    uint32_t resolution);

/// A light and its part of the maps.
struct LitLight {
    scene::Light light;
    uint32_t first_camera = 0;
    std::vector<LightCamera> cameras;
    /// What its intensity is spread over: a directional light's map, m², or solid angle, sr.
    float extent = 0;
};

/// What later passes read.
struct View {
    uint32_t resolution = 0;
    std::vector<LitLight> lights;
    rhi::View<rhi::Dimension::d2_array> depth;  ///< a layer per camera, 1 where nothing was hit; unbiased
    /// World, rgba32_float; a: 1 where something was hit.
    std::optional<rhi::View<rhi::Dimension::d2_array>> position;
    rhi::UniformBuffer block;  ///< a Block, for shaders/common/lights.glsl
};

class Shadow {
  public:
    /// Errors: those of the device; invalid_argument for a resolution outside its range.
    static Result<Shadow> create(rhi::Device& device, const Settings& settings, const Needs& needs);

    /// Draws all but blended surfaces, both faces of each: light does not pass a surface that is culled for
    /// cameras. `lights` as drawn_lights returns them, with no more cameras than Needs said.
    View record(rhi::Commands& commands, const scene::GeometryView& geometry,
                std::span<const scene::Light> lights);

    // The targets, to read them back; `position` is empty without Settings::position_target.
    const rhi::Texture& depth() const { return depth_; }
    const rhi::Texture& position() const { return position_; }

  private:
    void draw(rhi::Commands& commands, const scene::GeometryView& geometry, const LightCamera& camera,
              uint32_t layer) const;

    Settings settings_;
    Needs needs_;
    rhi::Texture depth_;
    rhi::Texture position_;
    rhi::RasterPipeline<shaders::shadow::depth> depth_pipeline_;
    rhi::RasterPipeline<shaders::shadow::masked> masked_pipeline_;
    rhi::RasterPipeline<shaders::shadow::position> position_pipelines_[2];  ///< by alpha test
};

}  // namespace lumo::shadow
