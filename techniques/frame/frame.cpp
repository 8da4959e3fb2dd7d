#include "techniques/frame/frame.hpp"

#include <algorithm>
#include <cstring>

#include "rhi/keep.hpp"
#include "techniques/cones/gather.hpp"
#include "techniques/voxels/octree_statistics.hpp"

namespace lumo::frame {

Result<Frame> Frame::create(rhi::Device& device, const Settings& asked, const Plan& plan,
                            const SceneFacts& facts, const scene::GeometryView& geometry,
                            const scene::Atmosphere* atmosphere) {
    if (asked.voxels.grid_size && asked.voxels.storage == voxels::Storage::octree) {
        return fail(ErrorKind::unsupported, "--grid-size",
                    "an octree is made for one place of the grid, and this one would move",
                    "use --storage vt, or --grid-size scene");
    }
    Frame frame;
    const Settings settings = frame.settings_ = resolve(asked, facts);
    frame.facts_ = facts;

    gbuffer::Needs gbuffer_needs = gbuffer::needs_of(geometry, settings.diffuse_materials);
    gbuffer_needs.emission = plan.needs("gbuffer.emission");
    gbuffer_needs.alpha_mask = plan.needs("gbuffer.mask");
    gbuffer_needs.normal_maps = plan.needs("gbuffer.normal_maps");
    Result<void> made =
        gbuffer::GBuffer::create(device, settings.size, gbuffer_needs).map(keep(frame.gbuffer_));

    if (made && plan.needs("shadow")) {
        made = shadow::Shadow::create(
                   device, settings.shadow,
                   {.alpha_mask = plan.needs("gbuffer.mask"), .cameras = std::max(facts.light_cameras, 1u)})
                   .map(keep(frame.shadow_));
    }
    const bool emission = frame.emission_ = plan.needs("voxels.emission");
    const bool environment = plan.needs("cones.environment");
    frame.sky_map_ = plan.needs("sky.map");
    frame.sky_pixels_ = plan.needs("sky.pixels");
    if (made && (frame.sky_map_ || frame.sky_pixels_)) {
        made = (atmosphere ? sky::Sky::create(device, *atmosphere, settings.sky)
                           : sky::Sky::create(device, sky::nothing(), sky::least_settings()))
                   .map(keep(frame.sky_));
    }
    if (made && frame.sky_pixels_) made = frame.sky_->create_pixels(device, settings.size);
    const bool sky_lights = frame.sky_map_ && facts.sky;
    const cones::Needs gather_needs{.emission = emission,
                                    .environment = environment,
                                    .sky = sky_lights,
                                    .anisotropic = settings.voxels.mips == voxels::MipKind::anisotropic,
                                    .octree_levels = settings.voxels.octree_levels()};
    voxels::OctreeSize octree;
    if (made && plan.needs("voxels") && settings.voxels.storage == voxels::Storage::octree) {
        made = voxels::count_octree(device, geometry, settings.voxels.resolution, settings.voxels.voxelizer)
                   .map(keep(octree));
    }
    if (made && plan.needs("voxels")) {
        made = voxels::Volume::create(device, settings.voxels,
                                      {.emission = emission,
                                       .alpha_mask = plan.needs("voxels.mask"),
                                       .translucent = plan.needs("voxels.opacity"),
                                       .lights = plan.needs("voxels.light"),
                                       .several_lights = facts.several_lights,
                                       .normals = plan.needs("voxels.bounce"),
                                       .triangles = voxels::count_triangles(geometry),
                                       .draws = uint32_t(geometry.draws.size()),
                                       .octree = std::move(octree)})
                   .map(keep(frame.volume_));
    }
    if (made && plan.needs("cones.emitters")) {
        made = cones::Emitters::create(device, settings.voxels).map(keep(frame.emitters_));
    }
    if (made && plan.needs("voxels.bounce")) {
        made = bounce::Bounce::create(device,
                                      {.bounces = settings.bounces,
                                       .cones = settings.cones,
                                       .rays = settings.gatherer == Gatherer::cones ? 0 : *settings.rays},
                                      {.emission = emission,
                                       .environment = environment,
                                       .sky = sky_lights,
                                       .several_lights = facts.several_lights},
                                      *frame.volume_)
                   .map(keep(frame.bounce_));
    }
    if (made && plan.needs("cones")) {
        made = cones::Irradiance::create(device, settings.cones, gather_needs, settings.size)
                   .map(keep(frame.irradiance_));
    }
    if (made && plan.needs("cones.rays")) {
        made = cones::Rays::create(device,
                                   {.count = *settings.rays, .smoothed = settings.gatherer == Gatherer::rays},
                                   gather_needs, settings.size)
                   .map(keep(frame.rays_));
    }
    if (made && plan.needs("cones.ao")) {
        made = cones::Irradiance::create(device, settings.cones,
                                         {.anisotropic = gather_needs.anisotropic,
                                          .octree_levels = gather_needs.octree_levels,
                                          .occlusion = true},
                                         settings.size)
                   .map(keep(frame.ao_));
    }
    const bool gathers = frame.irradiance_ || frame.rays_;
    const bool specular = plan.needs("cones.specular");
    if (made && gathers) {
        frame.cones_ = cones::distribute(settings.cones);
        made = device.create_sampler({.mip = rhi::FilterMode::linear}).map([&](rhi::Sampler sampler) {
            frame.volume_sampler_ = std::move(sampler);
        });
    }
    if (made && specular)
        made = cones::Specular::create(device, gather_needs, settings.size).map(keep(frame.specular_));
    if (made) {
        lighting::Needs needs = lighting::blend_needs_of(geometry);
        needs.lights = plan.needs("shadow");
        needs.indirect = gathers;
        needs.specular = specular;
        needs.sky = frame.sky_pixels_;
        needs.blend_air = plan.needs("blend.air");
        needs.sky_in_parts = frame.sky_pixels_ && frame.sky_->parts() > 1;
        needs.emission = gbuffer_needs.emission;
        needs.layers = settings.wants(Layer::direct) || settings.wants(Layer::indirect);
        needs.blend = frame.blend_ = plan.needs("blend");
        needs.diffuse_materials = settings.diffuse_materials;
        needs.gather = gather_needs;
        made = lighting::Lighting::create(device, settings.size, needs).map(keep(frame.lighting_));
    }
    if (made && plan.needs("post")) {
        made = post::Post::create(device, settings.post, settings.size).map(keep(frame.post_));
    }
    if (made) made = Layers::create(device, settings).map(keep(frame.layers_));
    if (!made) return tl::unexpected(made.error());
    return frame;
}

void Frame::record(rhi::Commands& commands, const Inputs& inputs) {
    const gbuffer::CameraBlock camera = gbuffer::camera_block(inputs.camera, settings_.size);
    const gbuffer::View gbuffer = gbuffer_->record(commands, inputs.geometry, camera);

    std::optional<shadow::View> lights;
    if (shadow_) lights = shadow_->record(commands, inputs.geometry, inputs.lights);

    const scene::Sky sky = inputs.sky.value_or(scene::Sky{.atmosphere = sky::nothing()});
    std::optional<rhi::Sampled<rhi::Dimension::d3>> sky_map;
    std::optional<sky::Pixels> sky_pixels;
    if (sky_map_) sky_map = sky_->record_map(commands, sky);
    if (sky_pixels_) sky_pixels = sky_->record_pixels(commands, gbuffer, sky, inputs.camera);

    std::optional<cones::Source> source;
    std::optional<rhi::View<rhi::Dimension::d2>> irradiance, ao;
    if (volume_) {
        std::optional<voxels::Grid> grid;
        if (const std::optional<float> side = settings_.voxels.grid_size)
            grid = voxels::grid_around(inputs.camera.position, *side, settings_.voxels.resolution);
        volume_->voxelize(commands, inputs.geometry, facts_.highest_emission, grid);
        volume_->inject(commands, lights && (irradiance_ || rays_) ? &*lights : nullptr);
        source = {.volume = volume_->view(), .environment = inputs.environment_radiance, .sky = sky_map};
        if (emitters_) source->emitters = emitters_->record(commands, *volume_);
        if (bounce_) source->volume = bounce_->record(commands, *volume_, *source);
        if (irradiance_) irradiance = irradiance_->record(commands, gbuffer, *source);
        if (rays_) {
            cones::Source seen = *source;
            if (settings_.gatherer == Gatherer::floor) seen.emitters.reset();
            irradiance = rays_->record(commands, gbuffer, seen);
        }
        source->occlusion_radius = settings_.ao_radius;
        if (ao_) ao = ao_->record(commands, gbuffer, *source);
    }

    std::optional<cones::Gather> gather;
    if (irradiance && (blend_ || specular_)) {
        gather = cones::make_gather(commands, cones_, *source, volume_sampler_);
    }
    std::optional<rhi::View<rhi::Dimension::d2>> specular;
    if (specular_ && gather) specular = specular_->record(commands, gbuffer, *gather, *irradiance);
    const lighting::View lit = lighting_->record(commands, {.gbuffer = gbuffer,
                                                            .lights = lights,
                                                            .irradiance = irradiance,
                                                            .specular = specular,
                                                            .gather = gather,
                                                            .sky = sky_pixels,
                                                            .environment = inputs.environment_radiance,
                                                            .geometry = inputs.geometry,
                                                            .eye = camera.eye});
    layers_->record(commands, {.gbuffer = gbuffer,
                               .camera = inputs.camera,
                               .radiance = lit.radiance,
                               .direct = lit.direct,
                               .indirect = lit.indirect,
                               .irradiance = irradiance,
                               .specular = specular,
                               .ao = ao,
                               .volume = source ? std::optional(source->volume) : std::nullopt,
                               .volume_emits = emission_});
    if (post_) post_->record(commands, lit.radiance);
}

Result<uint32_t> Frame::dropped_voxel_writes(rhi::Device& device) const {
    if (!volume_ || is_order_free(settings_.voxels.range)) return 0;
    return device.download(volume_->dropped_writes()).map([](const std::vector<std::byte>& bytes) {
        uint32_t count = 0;
        std::memcpy(&count, bytes.data(), sizeof count);
        return count;
    });
}

const rhi::Texture& Frame::texture(Layer layer) const {
    return layer == Layer::final ? post_->display() : layers_->texture(layer);
}

}  // namespace lumo::frame
