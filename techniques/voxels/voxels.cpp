#include "techniques/voxels/voxels.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <span>
#include <vector>

namespace lumo::voxels {
namespace {

using rhi::Dimension;
using rhi::Format;

/// sum_words of shaders/voxels/accumulator.glsl.
uint32_t sum_words(const Needs& needs) { return 4 + (needs.normals ? 3 : 0) + (needs.translucent ? 1 : 0); }

rhi::TextureDesc volume_desc(std::string name, Format format, uint32_t resolution) {
    return {.name = std::move(name),
            .dimension = Dimension::d3,
            .format = format,
            .extent = {resolution, resolution, resolution},
            .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage};
}

const char* pass_name(bool emission) { return emission ? "voxels.voxelize_emission" : "voxels.voxelize"; }

/// As shaders/voxels/large_list.glsl has it: of an indirect dispatch whose groups take the tiles of a triangle in
/// turns, along one axis each.
struct LargeArguments {
    uint32_t groups_x = 0;
    uint32_t groups_y = 4;
    uint32_t groups_z = 3;
    uint32_t count = 0;
};

/// Of shaders/voxels/small_triangles.glsl; no side has more groups than every device allows.
rhi::Groups triangle_groups(uint32_t triangles) {
    const uint32_t groups = rhi::groups_for(triangles, 64);
    const uint32_t rows = rhi::groups_for(groups, 65535);
    return {rhi::groups_for(groups, rows), rows};
}

float highest(glm::vec3 v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

std::string_view to_string(Voxelizer voxelizer) {
    return voxelizer == Voxelizer::raster ? "raster" : "compute";
}

rhi::Groups voxel_groups(uint32_t resolution) {
    return {rhi::groups_for(resolution, 8), rhi::groups_for(resolution, 4), rhi::groups_for(resolution, 4)};
}

uint64_t count_triangles(const scene::GeometryView& geometry) {
    uint64_t triangles = 0;
    for (const scene::DrawView& draw : geometry.draws)
        triangles += uint64_t(draw.index_count / 3) * draw.instances;
    return triangles;
}

Grid fit_grid(const scene::Bounds& bounds, uint32_t resolution) {
    if (bounds.empty()) return {.resolution = resolution};
    const float longest = std::max(highest(bounds.max - bounds.min), 1e-6f);
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
    return volume.create_textures(device)
        .and_then([&] { return volume.create_pipelines(device); })
        .and_then([&] { return Mips::create(device, settings.mips); })
        .map([&](Mips mips) {
            volume.mips_ = std::move(mips);
            return std::move(volume);
        });
}

Result<void> Volume::create_textures(rhi::Device& device) {
    const uint32_t resolution = settings_.resolution;
    const uint32_t words = sum_words(needs_);
    const uint32_t widest = device.info().limits.max_texture_side_3d;
    if (resolution * words > widest) {
        return fail(ErrorKind::limit, "--voxels",
                    fmt::format("{} voxels a side need a volume {} texels wide, and this device's end at {}",
                                resolution, resolution * words, widest),
                    fmt::format("use at most {}", widest / words));
    }
    rhi::TextureDesc sums = volume_desc("voxels.sums", Format::r32_uint, resolution);
    sums.extent.width *= words;

    struct Wanted {
        rhi::Texture* texture;
        rhi::TextureDesc desc;
    };
    const Wanted wanted[] = {
        {&sums_, std::move(sums)},
        {&albedo_, volume_desc("voxels.albedo", Format::rgba8_unorm, resolution)},
        {&area_, volume_desc("voxels.area", Format::r8_unorm, resolution)},
        // A program's bindings are all bound: one texel stands for a volume that this frame does without.
        {&normal_, volume_desc("voxels.normal", Format::rgba8_unorm, needs_.normals ? resolution : 1)},
        {&lit_texels_, volume_desc("voxels.lit_texels", Format::r32_uint, needs_.sunlight ? resolution : 1)},
    };
    for (const Wanted& w : wanted) {
        Result<rhi::Texture> made = device.create_texture(w.desc);
        if (!made) return tl::unexpected(made.error());
        *w.texture = std::move(*made);
    }
    if (settings_.voxelizer == Voxelizer::compute) {
        const std::pair<rhi::Buffer*, rhi::BufferDesc> buffers[] = {
            {&large_arguments_,
             {.name = "voxels.large_arguments",
              .size = std::max(needs_.draws, 1u) * sizeof(LargeArguments),
              .usage = rhi::BufferUsage::storage | rhi::BufferUsage::indirect}},
            {&large_list_,
             {.name = "voxels.large_triangles", .size = std::max<uint64_t>(needs_.triangles, 1) * 4}}};
        for (const auto& [buffer, desc] : buffers) {
            Result<rhi::Buffer> made = device.create_buffer(desc);
            if (!made) return tl::unexpected(made.error());
            *buffer = std::move(*made);
        }
    }
    const auto light = [&](const char* name, LightVolume& volume) {
        return LightVolume::create(device, name, resolution, settings_.mips, needs_.wide_range)
            .map([&](LightVolume made) { volume = std::move(made); });
    };
    Result<void> made = light("voxels.radiance", radiance_);
    if (made && needs_.emission) made = light("voxels.emission", emission_);
    return made;
}

Result<void> Volume::create_pipelines(rhi::Device& device) {
    const auto keep = [](auto& pipeline) { return [&pipeline](auto made) { pipeline = std::move(made); }; };
    for (const bool masked : {false, true}) {
        for (const bool emission : {false, true}) {
            if ((masked && !needs_.alpha_mask) || (emission && !needs_.emission)) continue;
            const auto create = [&]<class Options>(Options) {
                return Options{.alpha_test = masked,
                               .emission = emission,
                               .translucent = needs_.translucent,
                               .normals = needs_.normals};
            };
            Result<void> made;
            if (settings_.voxelizer == Voxelizer::raster) {
                using Program = shaders::voxels::voxelize;
                made = device
                           .create_raster_pipeline<Program>({.cull = rhi::CullMode::none},
                                                            create(Program::Options{}))
                           .map(keep(voxelize_[masked][emission]));
            } else {
                using Small = shaders::voxels::voxelize_small;
                using Large = shaders::voxels::voxelize_large;
                made = device.create_compute_pipeline<Small>(create(Small::Options{}))
                           .map(keep(voxelize_small_[masked][emission]));
                if (made) {
                    made = device.create_compute_pipeline<Large>(create(Large::Options{}))
                               .map(keep(voxelize_large_[masked][emission]));
                }
            }
            if (!made) return made;
        }
    }
    Result<void> made = device
                            .create_compute_pipeline<shaders::voxels::resolve>(
                                {.translucent = needs_.translucent, .normals = needs_.normals})
                            .map(keep(resolve_));
    if (made && needs_.emission) {
        made = device
                   .create_compute_pipeline<shaders::voxels::resolve_emission>(
                       {.translucent = needs_.translucent, .normals = needs_.normals})
                   .map(keep(resolve_emission_));
    }
    if (made && needs_.sunlight) {
        made = device.create_compute_pipeline<shaders::voxels::light>().map(keep(light_));
    }
    if (made) made = device.create_compute_pipeline<shaders::voxels::inject>().map(keep(inject_));
    return made;
}

void Volume::sum(rhi::Commands& commands, const scene::GeometryView& geometry, bool emission) {
    commands.pass(emission ? "voxels.clear_emission" : "voxels.clear")
        .clear(sums_.view(), std::array<uint32_t, 4>{});

    if (settings_.voxelizer == Voxelizer::raster) {
        sum_by_raster(commands, geometry, emission);
    } else {
        sum_by_compute(commands, geometry, emission);
    }
}

template <rhi::Program P>
typename P::Push Volume::push_of(const scene::DrawView& draw, uint32_t index, uint32_t first_triangle) const {
    return {.grid_origin = grid_.origin,
            .voxels_per_metre = 1 / grid_.voxel_size,
            .resolution = settings_.resolution,
            .first_index = draw.first_index,
            .first_instance = draw.first_instance,
            .emission_scale = 1 / emission_unit_,
            .triangles = draw.index_count / 3,
            .instances = draw.instances,
            .draw = index,
            .first_large = first_triangle};
}

void Volume::sum_by_raster(rhi::Commands& commands, const scene::GeometryView& geometry, bool emission) {
    const uint32_t side = settings_.resolution;
    rhi::RasterPass pass = commands.raster_pass(pass_name(emission), {.extent = {side, side, 1}});
    for (const scene::DrawView& draw : geometry.draws) {
        if (emission && !draw.emits) continue;
        const scene::MaterialTextures& textures = geometry.textures[draw.material];
        const bool masked = draw.alpha_mode == scene::AlphaMode::mask;
        pass.draw(voxelize_[masked][emission],
                  {.vertices = geometry.vertices,
                   .indices = geometry.indices,
                   .instances = geometry.instances,
                   .material = geometry.material(draw.material),
                   .base_color_texture = textures.base_color,
                   .emission_texture = textures.emission,
                   .sums = sums_.mip<Dimension::d3>(0)},
                  push_of<shaders::voxels::voxelize>(draw, 0, 0),
                  rhi::Draw{.vertices = draw.index_count, .instances = draw.instances * 3});
    }
}

void Volume::sum_by_compute(rhi::Commands& commands, const scene::GeometryView& geometry, bool emission) {
    rhi::Pass pass = commands.pass(pass_name(emission));
    const std::vector<LargeArguments> none_yet(needs_.draws);
    pass.upload(large_arguments_.slice(), std::as_bytes(std::span(none_yet)));
    const auto bindings = [&]<class P>(const scene::DrawView& draw, P) {
        const scene::MaterialTextures& textures = geometry.textures[draw.material];
        return typename P::Bindings{.vertices = geometry.vertices,
                                    .indices = geometry.indices,
                                    .instances = geometry.instances,
                                    .material = geometry.material(draw.material),
                                    .base_color_texture = textures.base_color,
                                    .emission_texture = textures.emission,
                                    .sums = sums_.mip<Dimension::d3>(0),
                                    .large_arguments = large_arguments_.slice(),
                                    .large_list = large_list_.slice()};
    };
    // All small ones first, so that the lists are made once the groups ask for them.
    for (const bool large : {false, true}) {
        uint32_t first_triangle = 0;
        for (uint32_t i = 0; i < geometry.draws.size(); ++i) {
            const scene::DrawView& draw = geometry.draws[i];
            if (emission && !draw.emits) continue;
            const bool masked = draw.alpha_mode == scene::AlphaMode::mask;
            const uint32_t triangles = draw.index_count / 3 * draw.instances;
            if (large) {
                using Program = shaders::voxels::voxelize_large;
                pass.dispatch_indirect(voxelize_large_[masked][emission], bindings(draw, Program{}),
                                       push_of<Program>(draw, i, first_triangle),
                                       large_arguments_.slice(i * sizeof(LargeArguments), 12), true);
            } else {
                using Program = shaders::voxels::voxelize_small;
                rhi::Groups groups = triangle_groups(triangles);
                groups.unordered = true;
                pass.dispatch(voxelize_small_[masked][emission], bindings(draw, Program{}),
                              push_of<Program>(draw, i, first_triangle), groups);
            }
            first_triangle += triangles;
        }
    }
}

void Volume::voxelize(rhi::Commands& commands, const scene::GeometryView& geometry, float max_emission) {
    grid_ = fit_grid(geometry.bounds, settings_.resolution);
    emission_unit_ = max_emission > 0 ? max_emission : 1;

    sum(commands, geometry, false);
    commands.pass("voxels.resolve")
        .dispatch(resolve_,
                  {.sums = sums_.mip<Dimension::d3>(0),
                   .albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .normal = normal_.mip<Dimension::d3>(0)},
                  {}, voxel_groups(settings_.resolution));
    if (!needs_.emission) return;

    sum(commands, geometry, true);
    rhi::Pass pass = commands.pass("voxels.emission");
    pass.dispatch(resolve_emission_,
                  {.sums = sums_.mip<Dimension::d3>(0),
                   .albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .emission = emission_.base.mip<Dimension::d3>(0)},
                  {}, voxel_groups(settings_.resolution));
    mips_.record(pass, emission_);
}

void Volume::inject(rhi::Commands& commands, const SunLight* sun) {
    const glm::vec3 irradiance = sun ? sun->irradiance : glm::vec3(0);
    // Stored radiance is 1 for a white surface that faces the sun, or that an emitter touches.
    const float unit =
        std::max(highest(irradiance) / glm::pi<float>(), needs_.emission ? emission_unit_ : 0.0f);
    injected_ = {.irradiance = irradiance,
                 .texel_voxel_faces = sun ? sun->texel_area / (grid_.voxel_size * grid_.voxel_size) : 0,
                 .radiance_scale = unit > 0 ? 1 / unit : 1};

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
                   .radiance = radiance_.base.mip<Dimension::d3>(0)},
                  injected_, voxel_groups(settings_.resolution));
    mips_.record(pass, radiance_);
}

View Volume::view() const {
    return {.grid = grid_,
            .radiance = view_of(radiance_),
            .emission = view_of(needs_.emission ? emission_ : radiance_),
            .radiance_unit = 1 / injected_.radiance_scale,
            .emission_unit = emission_unit_};
}

}  // namespace lumo::voxels
