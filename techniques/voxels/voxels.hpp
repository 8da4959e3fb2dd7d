// A voxel volume of the scene: its surfaces, and the light that leaves them, in volume textures. What is stored is every
// voxel of the grid, or a list of those that hold something with a sparse octree of their light (octree.hpp).
//
// voxelize() sums base colour (and emission) per voxel and resolves them to means; inject() turns the light of analytic
// lights, as their shadow maps saw it, into outgoing radiance; both end in the mips that cones sample. Surfaces have 8
// bits a channel, light what Range says.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "rhi/rhi.hpp"
#include "scene/gpu_scene.hpp"
#include "shaders/voxels/inject.hpp"
#include "shaders/voxels/light.hpp"
#include "shaders/voxels/resolve.hpp"
#include "shaders/voxels/resolve_emission.hpp"
#include "techniques/shadow/shadow.hpp"
#include "techniques/voxels/blocks.hpp"
#include "techniques/voxels/light_volume.hpp"
#include "techniques/voxels/octree.hpp"
#include "techniques/voxels/range.hpp"
#include "techniques/voxels/sums.hpp"
#include "techniques/voxels/voxelizer.hpp"

namespace lumo::voxels {

/// How voxels are stored: every voxel of the grid, or those that hold something, in a sparse octree.
enum class Storage : uint8_t { dense, octree };

struct Settings {
    uint32_t resolution = 128;  ///< voxels a side, a power of two, 16 to 1024
    MipKind mips = MipKind::anisotropic;
    VoxelizerKind voxelizer = VoxelizerKind::compute;
    Storage storage = Storage::dense;
    Range range = Range::ldr;
    bool moving = false;  ///< move() is called: what it needs is kept from frame to frame
    /// Metres: the side of a grid that follows the camera (grid_around), in a dense volume; none: the grid holds the scene.
    std::optional<float> grid_size = {};

    /// log2 of the resolution; 0: a dense volume.
    int32_t octree_levels() const;
};

/// What the scene needs of the volume; nothing else is made.
struct Needs {
    bool emission = false;        ///< some surface emits
    bool alpha_mask = false;      ///< some surface is cut out by its texture's alpha
    bool translucent = false;     ///< some surface is blended
    bool lights = false;          ///< there are analytic lights to inject
    bool several_lights = false;  ///< … and not one directional light alone
    bool normals = false;         ///< light is reflected on from voxel to voxel
    uint64_t triangles = 0;       ///< most that voxelize() is given, instances counted
    uint32_t draws = 0;           ///< most that voxelize() is given
    OctreeSize octree = {};       ///< room for an octree (count_octree); of a dense volume nothing is asked
};

/// The smallest grid that holds the bounds with half a voxel around them, so that walls on the bounds lie
/// inside voxels instead of on their faces.
Grid fit_grid(const scene::Bounds& bounds, uint32_t resolution);

/// A grid of this side, or up to 1/512 longer, around a position. It lies at multiples of eight voxels, so that what stands still keeps its
/// voxels, and their mips up to the third, while the position moves; the position is within four voxels of its middle.
Grid grid_around(glm::vec3 position, float side, uint32_t resolution);

/// What cones read. Volumes hold values times opacity; times their unit they are W/m²/sr.
struct View {
    Grid grid;
    LightVolumeView radiance;  ///< a: opacity
    LightVolumeView emission;  ///< the radiance again where nothing emits
    float radiance_unit = 1;
    float emission_unit = 1;  ///< both are such that half floats have room below and above what was injected
    /// Of the octree that both lights are bricks of; of a dense volume, one texel that nothing reads.
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> nodes;
    int32_t octree_levels = 0;  ///< log2 of the resolution; 0: a dense volume
    /// Of a dense volume, a uint32_t for each block of 4 x 4 x 4 voxels, x fastest, not 0 where it holds something; of an
    /// octree 4 bytes that nothing reads.
    rhi::StorageBuffer block_marks;
};

class Volume {
  public:
    /// Errors: those of the device; limit when its 3D textures are too small for the resolution.
    static Result<Volume> create(rhi::Device& device, const Settings& settings, const Needs& needs);

    /// Fills albedo, area, normal and emission from geometry. `max_emission` is the highest radiance of any
    /// emitter, W/m²/sr. `grid`: of the volume's resolution; none: fit_grid of the geometry. What lies outside is left out.
    void voxelize(rhi::Commands& commands, const scene::GeometryView& geometry, float max_emission,
                  const std::optional<Grid>& grid = {});
    /// As voxelize() of `after`, bit by bit, where only the draws of these numbers differ from `before`, which is what was
    /// last voxelized: they alone are voxelized, out of the old place and into the new one. All are where the grid
    /// changes, in an octree, and where the range is not order-free. Of a volume that is moving.
    void move(rhi::Commands& commands, const scene::GeometryView& before, const scene::GeometryView& after,
              std::span<const uint32_t> draws, float max_emission, const std::optional<Grid>& grid = {});
    /// Fills the radiance with what the lights' shadow maps saw, or with opacity alone, and makes its mips.
    void inject(rhi::Commands& commands, const shadow::View* lights);

    View view() const;
    const Settings& settings() const { return settings_; }
    /// The units of direct_flux(), and the radiance's scale.
    const shaders::voxels::inject::Push& injected() const { return injected_; }

    /// Textures for light of this volume's voxels.
    Result<LightVolume> create_light(rhi::Device& device, const std::string& name) const;
    /// What a program that runs once per cell writes of such a light; spread() takes it from there.
    rhi::View<rhi::Dimension::d3> light_cells(const LightVolume& light) const;
    /// Every level of a light from its cells.
    void spread(rhi::Pass& pass, const LightVolume& light) const;
    int32_t octree_levels() const;  ///< log2 of the resolution; 0: a dense volume
    rhi::Extent cells() const { return cells_; }
    /// Where the cells' voxels are, as Octree::voxels; of a dense volume 4 bytes that nothing reads.
    rhi::BufferSlice voxel_list() const;
    /// Of the octree's nodes; of a dense volume bytes that nothing reads.
    rhi::BufferSlice records() const;
    /// None of a dense volume.
    const Octree* octree() const { return octree_ ? &*octree_ : nullptr; }

    /// uint32_t: writes to voxels that the range mutex or average gave up in the last voxelize().
    rhi::BufferSlice dropped_writes() const { return sums_->dropped(); }
    const Sums& sums() const { return *sums_; }

    // Surfaces, a texel a cell.
    const rhi::Texture& albedo() const { return albedo_; }  ///< rgba8_unorm; a: opacity, 0 where empty
    const rhi::Texture& area() const { return area_; }      ///< r8_unorm, encode_area of voxel_grid.glsl
    const rhi::Texture& normal() const { return normal_; }  ///< rgba8_unorm, mean normal * 0.5 + 0.5
    const rhi::Texture& direct_flux() const { return direct_flux_; }  ///< r32_uint, shaders/voxels/flux.glsl
    const LightVolume& radiance() const { return radiance_; }
    const LightVolume& emission() const { return emission_; }  ///< empty where nothing emits

  private:
    /// A thread a cell, in groups of 4 x 4 x 4 (shaders/voxels/own_cell.glsl): where something is listed, of a dense
    /// volume.
    template <rhi::Program P>
    void for_each_cell(rhi::Pass& pass, const rhi::ComputePipeline<P>& pipeline,
                       const typename P::Bindings& bindings, const typename P::Push& push) const;
    const Blocks* blocks() const { return blocks_ ? &*blocks_ : nullptr; }
    rhi::BufferSlice block_list() const;
    CellLookup lookup() const;
    void resolve_surfaces(rhi::Commands& commands, bool keep);
    void resolve_emission(rhi::Commands& commands);
    void light(rhi::Commands& commands, const shadow::View& lights);
    Result<void> create_octree(rhi::Device& device);
    Result<void> create_textures(rhi::Device& device);
    Result<void> create_pipelines(rhi::Device& device);
    rhi::Sampled<rhi::Dimension::d3, rhi::TexelKind::uint> nodes() const;

    Settings settings_;
    Needs needs_;
    Grid grid_;
    float emission_unit_ = 1;  ///< W/m²/sr that is 1 to the sums
    shaders::voxels::inject::Push injected_{};

    rhi::Extent cells_;  ///< texels of the textures below
    std::optional<Sums> sums_;
    rhi::Texture albedo_;
    rhi::Texture area_;
    rhi::Texture normal_;
    rhi::Texture direct_flux_;
    LightVolume radiance_;
    LightVolume emission_;

    rhi::ComputePipeline<shaders::voxels::resolve> resolve_;
    rhi::ComputePipeline<shaders::voxels::resolve_emission> resolve_emission_;
    rhi::ComputePipeline<shaders::voxels::light> light_;
    rhi::ComputePipeline<shaders::voxels::inject> inject_;
    Mips mips_;

    std::optional<Octree> octree_;
    Voxelizer<Marks> mark_;
    std::optional<Blocks> blocks_;  ///< of a dense volume
    // What either storage binds in place of the other's.
    rhi::Texture no_nodes_;
    rhi::Buffer no_records_;
    rhi::Buffer no_blocks_;
    rhi::Buffer no_marks_;
    rhi::Sampler point_sampler_;
};

}  // namespace lumo::voxels
