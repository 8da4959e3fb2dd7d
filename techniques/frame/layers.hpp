// The linear layers of a frame, each in a float texture of its own.
#pragma once

#include <map>
#include <optional>

#include "rhi/rhi.hpp"
#include "shaders/frame/layer.hpp"
#include "shaders/frame/voxels.hpp"
#include "techniques/frame/settings.hpp"
#include "techniques/gbuffer/gbuffer.hpp"
#include "techniques/voxels/voxels.hpp"

namespace lumo::frame {

/// Where the layers come from. A layer whose source is missing stays black.
struct LayerSources {
    gbuffer::View gbuffer;
    scene::Camera camera;
    rhi::View<rhi::Dimension::d2> radiance;
    std::optional<rhi::View<rhi::Dimension::d2>> direct;
    std::optional<rhi::View<rhi::Dimension::d2>> indirect;
    std::optional<rhi::View<rhi::Dimension::d2>> irradiance;
    std::optional<rhi::View<rhi::Dimension::d2>> specular;
    std::optional<rhi::View<rhi::Dimension::d2>> ao;
    std::optional<voxels::View> volume;
    bool volume_emits = false;
};

class Layers {
  public:
    /// A texture for every wanted layer but final. Errors: those of the device.
    static Result<Layers> create(rhi::Device& device, const Settings& settings);

    /// Fills them: rgba32_float; a is 1.
    void record(rhi::Commands& commands, const LayerSources& sources);

    /// Of a layer that Settings asked for.
    const rhi::Texture& texture(Layer layer) const { return textures_.at(layer); }

  private:
    void copy(rhi::Pass& pass, Layer layer, std::optional<rhi::View<rhi::Dimension::d2>> source,
              const LayerSources& sources);

    rhi::Extent size_;
    std::map<Layer, rhi::Texture> textures_;
    rhi::Sampler point_sampler_;
    rhi::ComputePipeline<shaders::frame::layer> copy_;
    rhi::ComputePipeline<shaders::frame::layer> distance_;
    rhi::ComputePipeline<shaders::frame::voxels> voxels_;
};

}  // namespace lumo::frame
