#include "techniques/voxels/voxels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "rhi/keep.hpp"

namespace lumo::voxels {
namespace {

using rhi::Dimension;
using rhi::Format;

/// flux_words of shaders/voxels/flux.glsl.
uint32_t flux_words(const Needs& needs) { return needs.several_lights ? 4 : 1; }

rhi::TextureDesc volume_desc(std::string name, Format format, rhi::Extent extent) {
    return {.name = std::move(name),
            .dimension = Dimension::d3,
            .format = format,
            .extent = extent,
            .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage};
}

VoxelizerNeeds voxelizer_needs(const Needs& needs) {
    return {.alpha_mask = needs.alpha_mask, .triangles = needs.triangles, .draws = needs.draws};
}

/// Half floats hold light relative to its unit with 2^8 below their greatest number for what is reflected many times,
/// and the rest for what is faint: 11 bits down to 2^-22 of the unit, and something down to 2^-32.
float stored_unit(Range range) { return is_wide(range) ? 256.0f : 1.0f; }

constexpr auto every_draw = [](const scene::DrawView&) { return true; };

float highest(glm::vec3 v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

Grid fit_grid(const scene::Bounds& bounds, uint32_t resolution) {
    if (bounds.empty()) return {.resolution = resolution};
    const float longest = std::max(highest(bounds.max - bounds.min), 1e-6f);
    const float voxel = longest / float(resolution - 1);
    const glm::vec3 center = (bounds.min + bounds.max) * 0.5f;
    return {.origin = center - glm::vec3(voxel * float(resolution) * 0.5f),
            .voxel_size = voxel,
            .resolution = resolution};
}

Grid grid_around(glm::vec3 position, float side, uint32_t resolution) {
    constexpr float step = 8;  // voxels
    // Of few bits, so that whole numbers of voxels are exact.
    int exponent = 0;
    const float mantissa = std::frexp(side / float(resolution), &exponent);
    const float voxel = std::ldexp(std::ceil(mantissa * 1024), exponent - 10);
    const glm::vec3 middle = glm::floor(position / (step * voxel) + 0.5f) * step;
    return {
        .origin = (middle - 0.5f * float(resolution)) * voxel, .voxel_size = voxel, .resolution = resolution};
}

Result<Volume> Volume::create(rhi::Device& device, const Settings& settings, const Needs& needs) {
    Volume volume;
    volume.settings_ = settings;
    volume.needs_ = needs;
    return volume.create_octree(device)
        .and_then([&] { return volume.create_textures(device); })
        .and_then([&] { return volume.create_pipelines(device); })
        .and_then([&] { return Mips::create(device, settings.mips); })
        .map([&](Mips mips) {
            volume.mips_ = std::move(mips);
            return std::move(volume);
        });
}

Result<void> Volume::create_octree(rhi::Device& device) {
    const uint32_t resolution = settings_.resolution;
    cells_ = {resolution, resolution, resolution};
    Result<void> made = device
                            .create_sampler({.magnification = rhi::FilterMode::nearest,
                                             .minification = rhi::FilterMode::nearest})
                            .map(keep(point_sampler_));
    if (settings_.storage == Storage::dense) {
        if (made) made = Blocks::create(device, resolution).map(keep(blocks_));
        if (made) {
            made = device.create_texture(volume_desc("voxels.no_nodes", Format::rg32_uint, {}))
                       .map(keep(no_nodes_));
        }
        if (made) {
            made = device.create_buffer({.name = "voxels.no_records", .size = 12}).map(keep(no_records_));
        }
        return made;
    }
    if (made) made = device.create_buffer({.name = "voxels.no_marks", .size = 4}).map(keep(no_marks_));
    if (made) made = device.create_buffer({.name = "voxels.no_blocks", .size = 36}).map(keep(no_blocks_));
    if (made) {
        made = Octree::create(device,
                              {.resolution = resolution,
                               .mips = settings_.mips,
                               .wide_range = is_wide(settings_.range),
                               .list_voxels = needs_.normals},
                              needs_.octree)
                   .map(keep(octree_));
    }
    if (made) {
        cells_ = octree_->cell_extent();
        made = create_marker(device, settings_.voxelizer, voxelizer_needs(needs_)).map(keep(mark_));
    }
    return made;
}

Result<void> Volume::create_textures(rhi::Device& device) {
    rhi::TextureDesc flux =
        volume_desc("voxels.direct_flux", Format::r32_uint, needs_.lights ? cells_ : rhi::Extent{});
    flux.extent.width *= flux_words(needs_);

    struct Wanted {
        rhi::Texture* texture;
        rhi::TextureDesc desc;
    };
    const Wanted wanted[] = {
        {&albedo_, volume_desc("voxels.albedo", Format::rgba8_unorm, cells_)},
        {&area_, volume_desc("voxels.area", Format::r8_unorm, cells_)},
        // A program's bindings are all bound: one texel stands for a volume that this frame does without.
        {&normal_,
         volume_desc("voxels.normal", Format::rgba8_unorm, needs_.normals ? cells_ : rhi::Extent{})},
        {&direct_flux_, std::move(flux)},
    };
    for (const Wanted& w : wanted) {
        Result<rhi::Texture> made = device.create_texture(w.desc);
        if (!made) return tl::unexpected(made.error());
        *w.texture = std::move(*made);
    }
    empty_volumes(device, {&albedo_, &area_, &normal_, &direct_flux_});
    Result<void> made = create_light(device, "voxels.radiance").map(keep(radiance_));
    if (made && needs_.emission) made = create_light(device, "voxels.emission").map(keep(emission_));
    return made;
}

Result<LightVolume> Volume::create_light(rhi::Device& device, const std::string& name) const {
    if (octree_) return octree_->create_light(device, name);
    return LightVolume::create(device, name, settings_.resolution, settings_.mips, is_wide(settings_.range));
}

rhi::View<Dimension::d3> Volume::light_cells(const LightVolume& light) const {
    return (octree_ ? octree_->cells() : light.base).mip<Dimension::d3>(0);
}

void Volume::spread(rhi::Pass& pass, const LightVolume& light) const {
    if (octree_) {
        octree_->fill(pass, light);
    } else {
        mips_.record(pass, light, blocks());
    }
}

template <rhi::Program P>
void Volume::for_each_cell(rhi::Pass& pass, const rhi::ComputePipeline<P>& pipeline,
                           const typename P::Bindings& bindings, const typename P::Push& push) const {
    if (blocks_) {
        pass.dispatch_indirect(pipeline, bindings, push, blocks_->groups());
    } else {
        pass.dispatch(pipeline, bindings, push, rhi::groups_for(cells_, {4, 4, 4}));
    }
}

rhi::BufferSlice Volume::block_list() const { return blocks_ ? blocks_->list_slice() : no_blocks_.slice(); }

CellLookup Volume::lookup() const {
    return {nodes(), records(), blocks_ ? blocks_->marks() : no_marks_.slice()};
}

rhi::BufferSlice Volume::voxel_list() const { return octree_ ? octree_->voxels() : no_records_.slice(); }

Result<void> Volume::create_pipelines(rhi::Device& device) {
    Result<void> made = Sums::create(device,
                                     {.range = settings_.range,
                                      .voxelizer = settings_.voxelizer,
                                      .octree_levels = octree_levels(),
                                      .emission = needs_.emission,
                                      .translucent = needs_.translucent,
                                      .normals = needs_.normals,
                                      .keep = settings_.moving},
                                     voxelizer_needs(needs_), cells_)
                            .map(keep(sums_));
    if (made) {
        made = device
                   .create_compute_pipeline<shaders::voxels::resolve>({.translucent = needs_.translucent,
                                                                       .normals = needs_.normals,
                                                                       .range = int32_t(settings_.range),
                                                                       .octree_levels = octree_levels()})
                   .map(keep(resolve_));
    }
    if (made && needs_.emission) {
        made = device
                   .create_compute_pipeline<shaders::voxels::resolve_emission>(
                       {.emission = true,
                        .translucent = needs_.translucent,
                        .normals = needs_.normals,
                        .range = int32_t(settings_.range),
                        .octree_levels = octree_levels()})
                   .map(keep(resolve_emission_));
    }
    if (made && needs_.lights) {
        made = device
                   .create_compute_pipeline<shaders::voxels::light>(
                       {.octree_levels = octree_levels(), .several_lights = needs_.several_lights})
                   .map(keep(light_));
    }
    if (made) {
        made = device
                   .create_compute_pipeline<shaders::voxels::inject>(
                       {.octree_levels = octree_levels(), .several_lights = needs_.several_lights})
                   .map(keep(inject_));
    }
    return made;
}

void Volume::voxelize(rhi::Commands& commands, const scene::GeometryView& geometry, float max_emission,
                      const std::optional<Grid>& grid) {
    grid_ = grid.value_or(fit_grid(geometry.bounds, settings_.resolution));
    // Eight bits hold what is displayed, as the paper's do; an emitter may be brighter.
    emission_unit_ = is_wide(settings_.range) && max_emission > 0 ? max_emission : 1;

    if (octree_) {
        Occupancy& occupancy = octree_->occupancy();
        occupancy.clear(commands);
        mark_.record(commands, "octree.mark", geometry, grid_, Marks{occupancy.marks(), no_marks_.slice()}, 0,
                     every_draw);
        occupancy.record(commands);
        octree_->index(commands);
    }
    sums_->add_surfaces(commands, geometry, grid_, lookup(), blocks());
    resolve_surfaces(commands, false);
    if (!needs_.emission) return;
    sums_->add_emission(commands, geometry, grid_, lookup(), blocks(), 1 / emission_unit_);
    resolve_emission(commands);
}

void Volume::move(rhi::Commands& commands, const scene::GeometryView& before,
                  const scene::GeometryView& after, std::span<const uint32_t> draws, float max_emission,
                  const std::optional<Grid>& grid) {
    if (octree_ || !is_order_free(settings_.range) ||
        grid.value_or(fit_grid(after.bounds, settings_.resolution)) != grid_) {
        voxelize(commands, after, max_emission, grid);
        return;
    }
    sums_->move(commands, before, after, draws, grid_, lookup(), false, 0);
    resolve_surfaces(commands, true);
    if (!needs_.emission) return;
    sums_->move(commands, before, after, draws, grid_, lookup(), true, 1 / emission_unit_);
    resolve_emission(commands);
}

void Volume::resolve_surfaces(rhi::Commands& commands, bool keep) {
    rhi::Pass pass = commands.pass("voxels.resolve");
    if (blocks_) blocks_->list(pass, keep);
    for_each_cell(pass, resolve_,
                  {.sums = sums_->sums().mip<Dimension::d3>(0),
                   .exchanged = sums_->exchanged().mip<Dimension::d3>(0),
                   .floats = sums_->floats().mip<Dimension::d3>(0),
                   .albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .normal = normal_.mip<Dimension::d3>(0),
                   .blocks = block_list()},
                  {});
}

void Volume::resolve_emission(rhi::Commands& commands) {
    rhi::Pass pass = commands.pass("voxels.emission");
    for_each_cell(pass, resolve_emission_,
                  {.sums = sums_->sums(true).mip<Dimension::d3>(0),
                   .exchanged = sums_->exchanged().mip<Dimension::d3>(0),
                   .floats = sums_->floats().mip<Dimension::d3>(0),
                   .albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .emission_volume = light_cells(emission_),
                   .blocks = block_list()},
                  {.scale = stored_unit(settings_.range)});
    spread(pass, emission_);
}

void Volume::light(rhi::Commands& commands, const shadow::View& lights) {
    const float voxel_face = grid_.voxel_size * grid_.voxel_size;
    float flux_scale = 0, area_scale = 0;
    if (needs_.several_lights) {
        // Sums fit into 32 bits even where all the light falls into one voxel, and 4096 of its faces are lit.
        float flux = 0;
        for (const shadow::LitLight& lit : lights.lights) flux += highest(lit.light.intensity) * lit.extent;
        flux_scale = std::ldexp(1.0f, 31) / flux;
        area_scale = std::ldexp(1.0f, 20) / voxel_face;
        injected_.flux = glm::vec3(1 / (flux_scale * voxel_face));
        injected_.lit_area = std::ldexp(1.0f, -20);
        injected_.lights = float(lights.lights.size());
    } else {
        const shadow::LitLight& sun = lights.lights.front();
        injected_.lit_area = sun.cameras[0].texel_area() / voxel_face;
        injected_.flux = sun.light.intensity * injected_.lit_area;
        injected_.lights = 1;
    }

    rhi::Pass pass = commands.pass("voxels.light");
    if (blocks_) {
        blocks_->clear(pass, direct_flux_, flux_words(needs_));
    } else {
        pass.clear(direct_flux_.view(), std::array<uint32_t, 4>{});
    }
    const uint32_t groups = rhi::groups_for(lights.resolution, 16);
    for (size_t i = 0; i < lights.lights.size(); ++i) {
        const shadow::LitLight& lit = lights.lights[i];
        for (size_t c = 0; c < lit.cameras.size(); ++c) {
            pass.dispatch(light_,
                          {.lights = lights.block,
                           .shadow_maps = {lights.depth, point_sampler_},
                           .area = area_.mip<Dimension::d3>(0),
                           .direct_flux = direct_flux_.mip<Dimension::d3>(0),
                           .octree_nodes = nodes(),
                           .records = records()},
                          {.world_from_clip = lit.cameras[c].world_from_clip,
                           .grid_origin = grid_.origin,
                           .voxels_per_metre = 1 / grid_.voxel_size,
                           .light = int32_t(i),
                           .camera = int32_t(lit.first_camera + c),
                           .texel_area = lit.cameras[c].texel_area(),
                           .area_scale = area_scale,
                           .flux_scale = flux_scale,
                           .resolution = int32_t(settings_.resolution)},
                          {groups, groups});
        }
    }
}

void Volume::inject(rhi::Commands& commands, const shadow::View* lights) {
    // Stored radiance is 1 for a white surface that faces the sun, or has a local light a tenth of the grid away, or
    // that an emitter touches.
    float unit = needs_.emission ? emission_unit_ : 0.0f;
    injected_ = {};
    if (lights && !lights->lights.empty()) {
        const float distance = 0.1f * grid_.voxel_size * float(grid_.resolution);
        for (const shadow::LitLight& lit : lights->lights) {
            const bool sun = lit.light.kind == scene::LightKind::directional;
            unit = std::max(
                unit, highest(lit.light.intensity) / glm::pi<float>() / (sun ? 1 : distance * distance));
        }
        light(commands, *lights);
    }
    injected_.radiance_scale = stored_unit(settings_.range) / (unit > 0 ? unit : 1);

    rhi::Pass pass = commands.pass("voxels.inject");
    for_each_cell(pass, inject_,
                  {.albedo = albedo_.mip<Dimension::d3>(0),
                   .area = area_.mip<Dimension::d3>(0),
                   .direct_flux = direct_flux_.mip<Dimension::d3>(0),
                   .radiance = light_cells(radiance_),
                   .blocks = block_list()},
                  injected_);
    spread(pass, radiance_);
}

int32_t Settings::octree_levels() const {
    return storage == Storage::octree ? std::countr_zero(resolution) : 0;
}

int32_t Volume::octree_levels() const { return settings_.octree_levels(); }

rhi::Sampled<Dimension::d3, rhi::TexelKind::uint> Volume::nodes() const {
    if (octree_) return octree_->nodes();
    return {no_nodes_.view<Dimension::d3>(), point_sampler_};
}

rhi::BufferSlice Volume::records() const { return octree_ ? octree_->records() : no_records_.slice(); }

View Volume::view() const {
    return {.grid = grid_,
            .radiance = view_of(radiance_),
            .emission = view_of(needs_.emission ? emission_ : radiance_),
            .radiance_unit = 1 / injected_.radiance_scale,
            .emission_unit = emission_unit_ / stored_unit(settings_.range),
            .nodes = nodes(),
            .octree_levels = octree_levels(),
            .block_marks = lookup().block_marks};
}

}  // namespace lumo::voxels
