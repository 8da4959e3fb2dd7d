// The G-buffer: what each pixel's nearest opaque or alpha-tested surface is, for the shading that follows.
//
// Targets, all of the frame's size:
//  - base_color_metallic, rgba8_srgb: linear base colour; a: metallic
//  - normal_roughness, rgba16_float: world shading normal, unit length; a: perceptual roughness
//  - geometric_normal_occlusion, rgba16_float: interpolated vertex normal toward the viewer; a: occlusion, 1 is
//    open
//  - emission, rgba16_float: radiance, W/m²/sr; the colour of unlit surfaces
//  - depth, d32_float: 0 at the near plane, 1 where nothing was drawn; a position at distance z is known within
//    about z² 2^-22 / near plane
// Both normals are 0 where there is nothing to light: in the background and on unlit surfaces.
#pragma once

#include <array>
#include <optional>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/gbuffer/surface.hpp"
#include "shaders/gbuffer/surface_emission.hpp"

namespace lumo::gbuffer {

/// The uniform block of shaders/common/camera.glsl, for every program that includes it.
using CameraBlock = shaders::gbuffer::surface::Camera;

/// The block of a camera for an image of `size`, its aspect ratio included. An `up` along the axis is
/// replaced by -Z.
CameraBlock camera_block(const scene::Camera& camera, rhi::Extent size);

/// What the scene needs of the G-buffer; nothing else is made.
struct Needs {
    bool emission = false;           ///< some surface emits or is unlit
    bool alpha_mask = false;         ///< some surface is cut out by its texture's alpha
    bool normal_maps = false;        ///< some material has one
    bool double_sided = false;       ///< some surface is seen from both sides
    bool mirrored = false;           ///< some instance turns the winding
    bool diffuse_materials = false;  ///< neither metals, roughness nor occlusion are read: 0, 1 and 1
};

/// The needs of the opaque and alpha-tested draws of a scene.
Needs needs_of(const scene::GeometryView& geometry, bool diffuse_materials);

/// What later passes read. Row 0 of memory is the bottom of the picture.
struct View {
    rhi::Extent size;
    rhi::View<rhi::Dimension::d2> base_color_metallic;
    rhi::View<rhi::Dimension::d2> normal_roughness;
    rhi::View<rhi::Dimension::d2> geometric_normal_occlusion;
    std::optional<rhi::View<rhi::Dimension::d2>> emission;
    rhi::View<rhi::Dimension::d2> depth;
    rhi::UniformBuffer camera;  ///< a CameraBlock
};

class GBuffer {
  public:
    /// Errors: those of the device.
    static Result<GBuffer> create(rhi::Device& device, rhi::Extent size, const Needs& needs);

    /// Draws all but blended surfaces, in one pass. `camera` is for the size given to create. What `needs`
    /// left out is drawn without it; mirrored or double-sided surfaces then show the faces that the others
    /// show.
    View record(rhi::Commands& commands, const scene::GeometryView& geometry, const CameraBlock& camera);

    // The targets, to read them back.
    const rhi::Texture& base_color_metallic() const { return base_color_metallic_; }
    const rhi::Texture& normal_roughness() const { return normal_roughness_; }
    const rhi::Texture& geometric_normal_occlusion() const { return geometric_normal_occlusion_; }
    const rhi::Texture& emission() const { return emission_; }  ///< empty without Needs::emission
    const rhi::Texture& depth() const { return depth_; }

  private:
    template <class P>
    using Pipelines = std::array<std::array<rhi::RasterPipeline<P>, 3>, 2>;  ///< by alpha test, then CullMode

    template <class P>
    Result<void> make_pipelines(rhi::Device& device, Pipelines<P>& pipelines);
    template <class P>
    void draw_all(rhi::RasterPass& pass, const Pipelines<P>& pipelines, const scene::GeometryView& geometry,
                  rhi::UniformBuffer camera) const;

    Needs needs_;
    rhi::Texture base_color_metallic_;
    rhi::Texture normal_roughness_;
    rhi::Texture geometric_normal_occlusion_;
    rhi::Texture emission_;
    rhi::Texture depth_;
    Pipelines<shaders::gbuffer::surface> surface_;
    Pipelines<shaders::gbuffer::surface_emission> surface_emission_;
};

}  // namespace lumo::gbuffer
