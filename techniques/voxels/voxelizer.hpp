// A scene's triangles through the rasterizer or through compute, into some destination.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "rhi/keep.hpp"
#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"

namespace lumo::voxels {

/// Who finds the columns that a triangle covers. Both follow one rule, and differ at most where a column's centre line
/// lies on an edge, to within 1/256 of a voxel.
enum class VoxelizerKind : uint8_t { raster, compute };
std::string_view to_string(VoxelizerKind kind);

/// Where the grid lies: a cube around the scene's bounds, world space.
struct Grid {
    glm::vec3 origin{0};   ///< corner, metres
    float voxel_size = 1;  ///< metres
    uint32_t resolution = 128;

    bool operator==(const Grid&) const = default;
};

enum class Sign : uint8_t { add, subtract };

/// What voxelizers are made for.
struct VoxelizerNeeds {
    bool alpha_mask = false;  ///< some surface is cut out by its texture's alpha
    uint64_t triangles = 0;   ///< at most, instances counted
    uint32_t draws = 0;       ///< at most
};

/// Triangles of all draws, instances counted.
uint64_t count_triangles(const scene::GeometryView& geometry);

/// What every program of a voxelizer reads of a draw.
struct DrawSources {
    rhi::StorageBuffer vertices;
    rhi::StorageBuffer indices;
    rhi::StorageBuffer instances;
    rhi::UniformBuffer material;
    rhi::Sampled<rhi::Dimension::d2> base_color_texture;
    rhi::Sampled<rhi::Dimension::d2> emission_texture;
};

/// Triangles that are left to groups, layout: shaders/voxels/large_list.glsl.
struct LargeTriangles {
    rhi::StorageBuffer arguments;
    rhi::StorageBuffer list;
};

/// As shaders/voxels/large_list.glsl has it: of an indirect dispatch whose groups take the tiles of a triangle in turns,
/// along one axis each.
struct LargeArguments {
    uint32_t groups_x = 0;
    uint32_t groups_y = 1;
    uint32_t groups_z = 3;
    uint32_t count = 0;
};

/// Groups of shaders/voxels/small_triangles.glsl; no side has more than every device allows.
rhi::Groups triangle_groups(uint32_t triangles, uint32_t instances);

/// A Destination names three programs, and binds what they write:
///
///     struct Destination {
///         using Raster = shaders::…;  // of raster_vertex.glsl and raster_fragment.glsl
///         using Small = shaders::…;   // of small_triangles.glsl
///         using Large = shaders::…;   // of large_triangles.glsl
///         Raster::Bindings raster(const DrawSources&) const;
///         template <class P> typename P::Bindings compute(const DrawSources&, const LargeTriangles&) const;
///         static constexpr bool draws_alone = true;  // only where atomics that commute are not all that is written
///     };
template <class Destination>
class Voxelizer {
  public:
    /// `options`: a generic lambda, `<P>(bool alpha_test)` to the P::Options of each program. Errors: the device's.
    template <class MakeOptions>
    static Result<Voxelizer> create(rhi::Device& device, VoxelizerKind kind, const VoxelizerNeeds& needs,
                                    const MakeOptions& options);

    /// One pass: the draws that `wanted` is true for. Values of emission are multiplied by `emission_scale`. Sums of
    /// integers can be subtracted again, exactly.
    template <class Wanted>
    void record(rhi::Commands& commands, std::string_view pass_name, const scene::GeometryView& geometry,
                const Grid& grid, const Destination& destination, float emission_scale, const Wanted& wanted,
                Sign sign = Sign::add) const;

  private:
    using Raster = typename Destination::Raster;
    using Small = typename Destination::Small;
    using Large = typename Destination::Large;

    template <class P>
    static typename P::Push push_of(const Grid& grid, const scene::DrawView& draw, uint32_t index,
                                    uint32_t first_triangle, float emission_scale, Sign sign) {
        return {.grid_origin = grid.origin,
                .voxels_per_metre = 1 / grid.voxel_size,
                .resolution = grid.resolution,
                .first_index = draw.first_index,
                .first_instance = draw.first_instance,
                .emission_scale = emission_scale,
                .triangles = draw.index_count / 3,
                .instances = draw.instances,
                .draw = index,
                .first_large = first_triangle,
                .subtract = sign == Sign::subtract ? 1u : 0u};
    }
    static DrawSources sources_of(const scene::GeometryView& geometry, const scene::DrawView& draw) {
        const scene::MaterialTextures& textures = geometry.textures[draw.material];
        return {geometry.vertices,   geometry.indices, geometry.instances, geometry.material(draw.material),
                textures.base_color, textures.emission};
    }

    VoxelizerKind kind_ = VoxelizerKind::compute;
    uint32_t draws_ = 0;
    /// By alpha test.
    rhi::RasterPipeline<Raster> raster_[2];
    rhi::ComputePipeline<Small> small_[2];
    rhi::ComputePipeline<Large> large_[2];
    rhi::Buffer large_arguments_;
    rhi::Buffer large_list_;
};

template <class Destination>
template <class MakeOptions>
Result<Voxelizer<Destination>> Voxelizer<Destination>::create(rhi::Device& device, VoxelizerKind kind,
                                                              const VoxelizerNeeds& needs,
                                                              const MakeOptions& options) {
    Voxelizer voxelizer;
    voxelizer.kind_ = kind;
    voxelizer.draws_ = needs.draws;
    Result<void> made;
    for (const bool masked : {false, true}) {
        if (masked && !needs.alpha_mask) continue;
        if (kind == VoxelizerKind::raster) {
            made = device
                       .template create_raster_pipeline<Raster>({.cull = rhi::CullMode::none},
                                                                options.template operator()<Raster>(masked))
                       .map(keep(voxelizer.raster_[masked]));
        } else {
            made = device.template create_compute_pipeline<Small>(options.template operator()<Small>(masked))
                       .map(keep(voxelizer.small_[masked]));
            if (made) {
                made =
                    device.template create_compute_pipeline<Large>(options.template operator()<Large>(masked))
                        .map(keep(voxelizer.large_[masked]));
            }
        }
        if (!made) return tl::unexpected(made.error());
    }
    if (kind == VoxelizerKind::raster) return voxelizer;

    made = device
               .create_buffer({.name = "voxels.large_arguments",
                               .size = std::max(needs.draws, 1u) * sizeof(LargeArguments),
                               .usage = rhi::BufferUsage::storage | rhi::BufferUsage::indirect})
               .map(keep(voxelizer.large_arguments_));
    if (made) {
        made = device
                   .create_buffer({.name = "voxels.large_triangles",
                                   .size = std::max<uint64_t>(needs.triangles, 1) * sizeof(uint32_t)})
                   .map(keep(voxelizer.large_list_));
    }
    if (!made) return tl::unexpected(made.error());
    return voxelizer;
}

template <class Destination>
template <class Wanted>
void Voxelizer<Destination>::record(rhi::Commands& commands, std::string_view pass_name,
                                    const scene::GeometryView& geometry, const Grid& grid,
                                    const Destination& destination, float emission_scale,
                                    const Wanted& wanted, Sign sign) const {
    const auto is_masked = [](const scene::DrawView& draw) {
        return draw.alpha_mode == scene::AlphaMode::mask;
    };
    if (kind_ == VoxelizerKind::raster) {
        const uint32_t side = grid.resolution;
        std::optional<rhi::RasterPass> pass;
        for (const scene::DrawView& draw : geometry.draws) {
            if (!wanted(draw)) continue;
            if (!pass || requires { Destination::draws_alone; }) {
                pass.reset();
                pass.emplace(commands.raster_pass(pass_name, {.extent = {side, side, 1}}));
            }
            pass->draw(raster_[is_masked(draw)], destination.raster(sources_of(geometry, draw)),
                       push_of<Raster>(grid, draw, 0, 0, emission_scale, sign),
                       rhi::Draw{.vertices = draw.index_count, .instances = draw.instances * 3});
        }
        return;
    }

    if (geometry.draws.empty()) return;
    rhi::Pass pass = commands.pass(pass_name);
    // More groups share a triangle where it may cover many columns.
    const std::vector<LargeArguments> none_yet(std::max(draws_, 1u),
                                               {.groups_y = std::max(grid.resolution / 128, 1u)});
    pass.upload(large_arguments_.slice(), std::as_bytes(std::span(none_yet)));
    const LargeTriangles large{large_arguments_.slice(), large_list_.slice()};
    // All small ones first: a barrier in all, not one a draw.
    for (const bool large_ones : {false, true}) {
        uint32_t first_triangle = 0;
        for (uint32_t i = 0; i < geometry.draws.size(); ++i) {
            const scene::DrawView& draw = geometry.draws[i];
            if (!wanted(draw)) continue;
            const DrawSources sources = sources_of(geometry, draw);
            const uint32_t triangles = draw.index_count / 3 * draw.instances;
            if (large_ones) {
                pass.dispatch_indirect(large_[is_masked(draw)],
                                       destination.template compute<Large>(sources, large),
                                       push_of<Large>(grid, draw, i, first_triangle, emission_scale, sign),
                                       large_arguments_.slice(i * sizeof(LargeArguments), 12), true);
            } else {
                rhi::Groups groups = triangle_groups(draw.index_count / 3, draw.instances);
                groups.unordered = true;
                pass.dispatch(small_[is_masked(draw)], destination.template compute<Small>(sources, large),
                              push_of<Small>(grid, draw, i, first_triangle, emission_scale, sign), groups);
            }
            first_triangle += triangles;
        }
    }
}

}  // namespace lumo::voxels
