#include "techniques/voxels/voxels.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

namespace lumo::voxels {
namespace {

using rhi::Dimension;
using rhi::Format;
using rhi::TextureUsage;

constexpr uint32_t sum_words(bool translucent) { return translucent ? 5 : 4; }

rhi::TextureDesc volume_desc(std::string name, Format format, uint32_t resolution, bool with_mips = false) {
    return {.name = std::move(name),
            .dimension = Dimension::d3,
            .format = format,
            .extent = {resolution, resolution, resolution},
            .mips = with_mips ? rhi::full_mips({resolution, resolution, resolution}) : 1,
            .usage = TextureUsage::sampled | TextureUsage::storage};
}

/// Groups of the per-voxel programs, 8 x 4 x 4 voxels each.
rhi::Groups voxel_groups(uint32_t resolution) {
    return {rhi::groups_for(resolution, 8), rhi::groups_for(resolution, 4), rhi::groups_for(resolution, 4)};
}

float highest(glm::vec3 v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

Grid fit_grid(const scene::Bounds& bounds, uint32_t resolution) {
    if (bounds.empty()) return {.resolution = resolution};
    const glm::vec3 size = bounds.max - bounds.min;
    const float longest = std::max(highest(size), 1e-6f);
    const float voxel = longest / float(resolution - 1);
    const glm::vec3 center = (bounds.min + bounds.max) * 0.5f;
    return {.origin = center - glm::vec3(voxel * float(resolution) * 0.5f),
            .voxel_size = voxel,
            .resolution = resolution};
}

Result<Volume> Volume::create(rhi::Device& device, const Settings& settings, const Needs& needs) {
    Volume volume;
    volume.settings_ = settings;
    volume.needs_ = needs;
    const uint32_t resolution = settings.resolution;
    const uint32_t words = sum_words(needs.translucent);
    const uint32_t widest = device.info().limits.max_texture_side_3d;
    if (resolution * words > widest) {
        return fail(ErrorKind::limit, "--voxels",
                    fmt::format("{} voxels need a 3D texture {} texels wide; this device's end at {}", resolution,
                                resolution * words, widest),
                    fmt::format("use at most {} voxels", widest / words));
    }

    auto make = [&](rhi::Texture& texture, const rhi::TextureDesc& desc) {
        return device.create_texture(desc).map([&](rhi::Texture made) { texture = std::move(made); });
    };
    rhi::TextureDesc sums = volume_desc("voxels.sums", Format::r32_uint, resolution);
    sums.extent.width *= words;
    auto textures = make(volume.sums_, sums)
                        .and_then([&] { return make(volume.albedo_, volume_desc("voxels.albedo", Format::rgba8_unorm, resolution)); })
                        .and_then([&] { return make(volume.area_, volume_desc("voxels.area", Format::r8_unorm, resolution)); })
                        .and_then([&] { return make(volume.lit_texels_, volume_desc("voxels.lit_texels", Format::r32_uint, needs.sunlight ? resolution : 1)); })
                        .and_then([&] { return make(volume.radiance_, volume_desc("voxels.radiance", Format::rgba8_unorm, resolution, true)); });
    if (textures && needs.emission) {
        textures = make(volume.emission_, volume_desc("voxels.emission", Format::rgba8_unorm, resolution, true));
    }
    if (!textures) return tl::unexpected(textures.error());

    auto keep = [](auto& pipeline) {
        return [&pipeline](auto made) { pipeline = std::move(made); };
    };
    const rhi::RasterState raster{.cull = rhi::CullMode::none};
    Result<void> made;
    for (bool masked : {false, true}) {
        for (bool emission : {false, true}) {
            if (!made || (masked && !needs.alpha_mask) || (emission && !needs.emission)) continue;
            made = device
                       .create_raster_pipeline<shaders::voxels::voxelize>(
                           raster, {.alpha_test = masked, .emission = emission, .translucent = needs.translucent})
                       .map(keep(volume.voxelize_[masked][emission]));
        }
    }
    if (made) {
        made = device.create_compute_pipeline<shaders::voxels::resolve>({.translucent = needs.translucent})
                   .map(keep(volume.resolve_));
    }
    if (made && needs.emission) {
        made = device.create_compute_pipeline<shaders::voxels::resolve_emission>({.translucent = needs.translucent})
                   .map(keep(volume.resolve_emission_));
    }
    if (made && needs.sunlight) {
        made = device.create_compute_pipeline<shaders::voxels::light>().map(keep(volume.light_));
    }
    if (made) made = device.create_compute_pipeline<shaders::voxels::inject>().map(keep(volume.inject_));
    if (made) made = device.create_compute_pipeline<shaders::voxels::mip>().map(keep(volume.mip_));
    if (!made) return tl::unexpected(made.error());
    return volume;
}

void Volume::draw(rhi::Commands& commands, const scene::GeometryView& geometry, bool emitters_only) {
    {
        rhi::Pass clear = commands.pass(emitters_only ? "voxels.clear_emission" : "voxels.clear");
        clear.clear(sums_.view(), std::array<uint32_t, 4>{});
    }
    const uint32_t side = settings_.resolution;
    rhi::RasterPass pass = commands.raster_pass(emitters_only ? "voxels.voxelize_emission" : "voxels.voxelize",
                                                {.extent = {side, side, 1}});
    for (const scene::DrawView& draw : geometry.draws) {
        if (emitters_only && !draw.emits) continue;
        const scene::MaterialTextures& textures = geometry.textures[draw.material];
        const bool masked = draw.alpha_mode == scene::AlphaMode::mask;
        pass.draw(voxelize_[masked][emitters_only],
                  {.vertices = geometry.vertices,
                   .indices = geometry.indices,
                   .instances = geometry.instances,
                   .materials = geometry.materials,
                   .base_color_texture = textures.base_color,
                   .emission_texture = textures.emission,
                   .sums = sums_.mip<Dimension::d3>(0)},
                  {.grid_origin = grid_.origin,
                   .voxels_per_metre = 1 / grid_.voxel_size,
                   .resolution = side,
                   .first_index = draw.first_index,
                   .first_instance = draw.first_instance,
                   .material = draw.material,
                   .emission_scale = 1 / emission_unit_},
                  rhi::Draw{.vertices = draw.index_count, .instances = draw.instances * 3});
    }
}

void Volume::voxelize(rhi::Commands& commands, const scene::GeometryView& geometry, float max_emission) {
    grid_ = fit_grid(geometry.bounds, settings_.resolution);
    emission_unit_ = max_emission > 0 ? max_emission : 1;

    draw(commands, geometry, false);
    {
        rhi::Pass pass = commands.pass("voxels.resolve");
        pass.dispatch(resolve_,
                      {.sums = sums_.mip<Dimension::d3>(0),
                       .albedo = albedo_.mip<Dimension::d3>(0),
                       .area = area_.mip<Dimension::d3>(0)},
                      {}, voxel_groups(settings_.resolution));
    }
    if (!needs_.emission) return;
    draw(commands, geometry, true);
    rhi::Pass pass = commands.pass("voxels.resolve_emission");
    pass.dispatch(resolve_emission_,
                  {.sums = sums_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .emission = emission_.mip<Dimension::d3>(0)},
                  {}, voxel_groups(settings_.resolution));
    make_mips(pass, emission_);
}

void Volume::inject(rhi::Commands& commands, const SunLight* sun) {
    const glm::vec3 irradiance = sun ? sun->irradiance : glm::vec3(0);
    // The most that a surface of albedo 1 facing the sun sends out.
    radiance_unit_ = highest(irradiance) > 0 ? highest(irradiance) / glm::pi<float>() : 1;

    if (sun) {
        rhi::Pass pass = commands.pass("voxels.light");
        pass.clear(lit_texels_.view(), std::array<uint32_t, 4>{});
        const uint32_t groups = rhi::groups_for(sun->shadow_resolution, 16);
        pass.dispatch(light_,
                      {.shadow_depth = sun->shadow_depth,
                       .area = area_.mip<Dimension::d3>(0),
                       .lit_texels = lit_texels_.mip<Dimension::d3>(0)},
                      {.world_from_light_clip = sun->world_from_light_clip,
                       .grid_origin = grid_.origin,
                       .voxels_per_metre = 1 / grid_.voxel_size,
                       .direction_to_sun = sun->direction_to_sun},
                      {groups, groups});
    }
    rhi::Pass pass = commands.pass("voxels.inject");
    pass.dispatch(inject_,
                  {.albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .lit_texels = lit_texels_.mip<Dimension::d3>(0),
                   .radiance = radiance_.mip<Dimension::d3>(0)},
                  {.irradiance = irradiance,
                   .texel_voxel_faces = sun ? sun->texel_area / (grid_.voxel_size * grid_.voxel_size) : 0,
                   .radiance_scale = 1 / radiance_unit_},
                  voxel_groups(settings_.resolution));
    make_mips(pass, radiance_);
}

void Volume::make_mips(rhi::Pass& pass, const rhi::Texture& volume) {
    for (uint32_t level = 1; level < volume.desc().mips; ++level) {
        const uint32_t groups = rhi::groups_for(std::max(settings_.resolution >> level, 1u), 4);
        pass.dispatch(mip_,
                      {.finer = volume.mip<Dimension::d3>(level - 1), .coarser = volume.mip<Dimension::d3>(level)}, {},
                      {groups, groups, groups});
    }
}

View Volume::view() const {
    const rhi::Texture& emission = needs_.emission ? emission_ : radiance_;
    return {.grid = grid_,
            .radiance = radiance_.view<Dimension::d3>(),
            .emission = emission.view<Dimension::d3>(),
            .radiance_unit = radiance_unit_,
            .emission_unit = emission_unit_,
            .has_emission = needs_.emission};
}

}  // namespace lumo::voxels
