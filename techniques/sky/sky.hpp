// The sky in a frame: what every pixel sees of it, and a map of it for the light that it sends into the scene.
// docs/sky.md says how spectra become colours.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "rhi/rhi.hpp"
#include "scene/scene.hpp"
#include "shaders/sky/cones.hpp"
#include "shaders/sky/map.hpp"
#include "shaders/sky/pixels.hpp"
#include "techniques/atmosphere/atmosphere.hpp"
#include "techniques/gbuffer/gbuffer.hpp"

namespace lumo::sky {

struct Settings {
    atmosphere::Settings tables = {};
    uint32_t map_side = 128;  ///< texels, a power of two from 32 to 2048
    /// What `tables` asks for, on the same device and by fours; none: they are taken from the user's cache, or computed.
    std::shared_ptr<const std::vector<atmosphere::Tables>> made = {};
};

/// Air without anything in it under no sun, which changes no picture: for what is made without being needed; and
/// settings that are enough for it.
scene::Atmosphere nothing();
Settings least_settings();

/// What shaders/sky/before.glsl reads, for up to four wavelengths.
struct Air {
    atmosphere::Sky tables;
    rhi::UniformBuffer view;
};

/// rgba32_float of the frame's size; a is 1. A pixel's radiance is what its surface sends times `transmittance`, plus
/// `radiance`; negative values count as 0.
struct Pixels {
    rhi::View<rhi::Dimension::d2> radiance;
    rhi::View<rhi::Dimension::d2> transmittance;
    std::vector<Air>
        before;  ///< the same for surfaces that are not in the G-buffer: the sum over all of these
};

class Sky {
  public:
    /// Errors: invalid_argument (map_side; a setting of the tables), and those of the device.
    static Result<Sky> create(rhi::Device& device, const scene::Atmosphere& atmosphere,
                              const Settings& settings = {});
    /// What record_pixels fills. Errors: those of the device.
    Result<void> create_pixels(rhi::Device& device, rhi::Extent size);

    /// Radiance from every direction at the world's origin, without the sun's disc, W/m²/sr: what shaders/sky/map.glsl
    /// reads.
    rhi::Sampled<rhi::Dimension::d3> record_map(rhi::Commands& commands, const scene::Sky& sky);

    /// What lies between the camera and the surfaces of the G-buffer, and behind: the planet's ground and, with the sun's
    /// disc, the sky.
    Pixels record_pixels(rhi::Commands& commands, const gbuffer::View& gbuffer, const scene::Sky& sky,
                         const scene::Camera& camera);

    /// How many sets of up to four wavelengths there are: Pixels::before.
    size_t parts() const { return parts_.size(); }
    /// The map's texture, to read it back: level 0 has the radiances.
    const rhi::Texture& map() const { return map_; }
    const rhi::Texture& radiance() const { return radiance_; }  ///< what record_pixels fills

  private:
    using Block = shaders::sky::map::Sky;

    /// The tables of up to four wavelengths, and what they weigh.
    struct Part {
        const atmosphere::Tables* tables;
        Block weights;
    };
    Block block(const Part& part, const scene::Sky& sky, glm::vec3 position) const;

    std::shared_ptr<const std::vector<atmosphere::Tables>> tables_;
    std::vector<Part> parts_;
    double radius_ground_km_ = 0;
    rhi::Texture map_;
    rhi::Texture radiance_;
    rhi::Texture transmittance_;
    rhi::Sampler map_sampler_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::sky::map> map_pipeline_;
    rhi::ComputePipeline<shaders::sky::cones> cones_pipeline_;
    rhi::ComputePipeline<shaders::sky::pixels> pixels_pipeline_;
};

/// The map that record_map filled last, as Scene::environment_map wants it: 2 `rows` by `rows`. Waits for it. Errors:
/// those of the device.
Result<scene::ImageF> download_map(rhi::Device& device, const Sky& sky, uint32_t rows);

}  // namespace lumo::sky
