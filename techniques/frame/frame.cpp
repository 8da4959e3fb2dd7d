#include "techniques/frame/frame.hpp"

#include <algorithm>

#include "techniques/cones/gather.hpp"

namespace lumo::frame {
namespace {

/// Moves what was made into its place, or hands on why it was not.
template <class T>
Result<void> keep(Result<T> made, std::optional<T>& place) {
    return std::move(made).map([&](T value) { place = std::move(value); });
}

}  // namespace

Result<Frame> Frame::create(rhi::Device& device, const Settings& settings, const Plan& plan,
                            const SceneFacts& facts, const scene::GeometryView& geometry) {
    Frame frame;
    frame.settings_ = settings;
    frame.facts_ = facts;

    gbuffer::Needs gbuffer_needs = gbuffer::needs_of(geometry, settings.diffuse_materials);
    gbuffer_needs.emission = plan.needs("gbuffer.emission");
    gbuffer_needs.alpha_mask = plan.needs("gbuffer.mask");
    gbuffer_needs.normal_maps = plan.needs("gbuffer.normal_maps");
    Result<void> made = keep(gbuffer::GBuffer::create(device, settings.size, gbuffer_needs), frame.gbuffer_);

    if (made && plan.needs("shadow")) {
        made =
            keep(shadow::Shadow::create(device, settings.shadow, {.alpha_mask = plan.needs("gbuffer.mask")}),
                 frame.shadow_);
    }
    const bool emission = frame.emission_ = plan.needs("voxels.emission");
    const bool environment = plan.needs("cones.environment");
    const cones::Needs gather_needs{.emission = emission,
                                    .environment = environment,
                                    .anisotropic = settings.voxels.mips == voxels::MipKind::anisotropic};
    if (made && plan.needs("voxels")) {
        made = keep(voxels::Volume::create(device, settings.voxels,
                                           {.emission = emission,
                                            .alpha_mask = plan.needs("voxels.mask"),
                                            .translucent = plan.needs("voxels.opacity"),
                                            .sunlight = plan.needs("voxels.sunlight"),
                                            .normals = plan.needs("voxels.bounce"),
                                            .wide_range = facts.wide_range()}),
                    frame.volume_);
    }
    if (made && plan.needs("voxels.bounce")) {
        made = keep(bounce::Bounce::create(
                        device, {.bounces = settings.bounces, .cones = settings.cones.count},
                        {.emission = emission, .environment = environment, .wide_range = facts.wide_range()},
                        settings.voxels),
                    frame.bounce_);
    }
    if (made && plan.needs("cones")) {
        made = keep(cones::Irradiance::create(device, settings.cones, gather_needs, settings.size),
                    frame.irradiance_);
    }
    if (made) {
        lighting::Needs needs = lighting::blend_needs_of(geometry);
        needs.sun = plan.needs("shadow");
        needs.indirect = plan.needs("cones");
        needs.emission = gbuffer_needs.emission;
        needs.layers = settings.wants(Layer::direct) || settings.wants(Layer::indirect);
        needs.blend = frame.blend_ = plan.needs("blend");
        needs.diffuse_materials = settings.diffuse_materials;
        needs.gather = gather_needs;
        made = keep(lighting::Lighting::create(device, settings.size, needs), frame.lighting_);
    }
    if (made && plan.needs("post")) {
        made = keep(post::Post::create(device, settings.post, settings.size), frame.post_);
    }
    if (made) made = keep(Layers::create(device, settings), frame.layers_);
    if (!made) return tl::unexpected(made.error());
    return frame;
}

void Frame::record(rhi::Commands& commands, const Inputs& inputs) {
    const gbuffer::CameraBlock camera = gbuffer::camera_block(inputs.camera, settings_.size);
    const gbuffer::View gbuffer = gbuffer_->record(commands, inputs.geometry, camera);

    std::optional<lighting::Sunlight> sun;
    if (shadow_) {
        sun = {.shadow = shadow_->record(commands, inputs.geometry, inputs.direction_to_sun),
               .irradiance = inputs.sun_irradiance};
    }

    std::optional<voxels::View> volume;
    std::optional<rhi::View<rhi::Dimension::d2>> irradiance;
    if (volume_) {
        volume_->voxelize(commands, inputs.geometry, facts_.highest_emission);
        std::optional<voxels::SunLight> injected;
        if (sun) {
            injected = {.shadow_depth = {sun->shadow.depth, irradiance_->point_sampler()},
                        .shadow_resolution = sun->shadow.resolution,
                        .world_from_light_clip = sun->shadow.camera.world_from_clip,
                        .texel_area = sun->shadow.texel_area,
                        .direction_to_sun = sun->shadow.camera.direction_to_light,
                        .irradiance = sun->irradiance};
        }
        volume_->inject(commands, injected ? &*injected : nullptr);
        volume = bounce_ ? bounce_->record(commands, *volume_, inputs.environment_radiance) : volume_->view();
        irradiance = irradiance_->record(commands, gbuffer, *volume, inputs.environment_radiance);
    }

    std::optional<cones::Gather> gather;
    if (volume && blend_) {
        gather = cones::make_gather(commands, irradiance_->distribution(), *volume,
                                    irradiance_->volume_sampler(), inputs.environment_radiance);
    }
    const lighting::View lit = lighting_->record(commands, {.gbuffer = gbuffer,
                                                            .sun = sun,
                                                            .irradiance = irradiance,
                                                            .gather = gather,
                                                            .environment = inputs.environment_radiance,
                                                            .geometry = inputs.geometry,
                                                            .eye = camera.eye});
    layers_->record(commands, {.gbuffer = gbuffer,
                               .camera = inputs.camera,
                               .radiance = lit.radiance,
                               .direct = lit.direct,
                               .indirect = lit.indirect,
                               .irradiance = irradiance,
                               .volume = volume,
                               .volume_emits = emission_});
    if (post_) post_->record(commands, lit.radiance);
}

const rhi::Texture& Frame::texture(Layer layer) const {
    return layer == Layer::final ? post_->display() : layers_->texture(layer);
}

}  // namespace lumo::frame
