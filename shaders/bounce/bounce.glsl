// Radiance that leaves each voxel's surfaces when analytic lights light them and they gather light from the other
// voxels: one more reflection than the volume that is gathered from holds. The includer includes cones/gather.glsl before,
// and defines side_irradiance().
#define FLUX 3
#include "voxels/block_marks.glsl"
#include "voxels/reflect.glsl"

// A group takes a block of cells and gathers for those that hold surfaces, which are few, side by side.
const int block_size = 512;
// Number by number: a vector chosen by a specialization constant comes out wrong on some drivers.
ivec3 block_log2() { return ivec3(octree_levels > 0 ? 6 : 3, 3, octree_levels > 0 ? 0 : 3); }
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    vec3 flux;             // FluxUnits
    float lit_area;
    float lights;
    float radiance_scale;  // stored = radiance * radiance_scale
    int rays;              // a side of a voxel, where they gather
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, rgba8) readonly uniform image3D normal;
layout(binding = 4) writeonly uniform image3D radiance;  // times opacity; a: opacity
layout(binding = 30, std430) readonly buffer Voxels { uint data[]; } voxels;  // as voxels/octree_index.comp lists them

shared uint occupied;
shared uint places[block_size];

// The voxel that a cell belongs to.
ivec3 voxel_of(ivec3 cell) {
    if (octree_levels == 0) return cell;
    uint voxel = voxels.data[place_of_cell(cell)];
    return ivec3(uvec3(voxel, voxel >> 10, voxel >> 20) & 1023u);
}

ivec3 cell_in_block(uint place) {
    ivec3 bits = block_log2();
    ivec3 offsets = ivec3(place) >> ivec3(0, bits.x, bits.x + bits.y);
    return (ivec3(gl_WorkGroupID) << bits) + (offsets & (ivec3(1) << bits) - 1);
}

// Indirect irradiance of a side of a voxel's surface, W/m². `position`: of its middle, in grid space; `turn`: as turn_of.
vec3 side_irradiance(vec3 position, vec3 side, uint turn);

void reflect_from(ivec3 cell) {
    vec4 surface = imageLoad(albedo, cell);
    FluxUnits units = FluxUnits(push.flux, push.lit_area, push.lights);
    vec3 irradiance = direct_irradiance(units, cell, imageLoad(area, cell).r);

    vec3 facing = imageLoad(normal, cell).xyz * 2.0 - 1.0;
    float agreement = sqrt(inner(facing, facing));
    // Where a voxel's surfaces face opposite ways the mean says nothing, and both sides count.
    int sides = agreement > 0.25 ? 1 : 2;
    vec3 side = agreement > 0.25 ? facing / agreement : vec3(0, 1, 0);
    ivec3 voxel = voxel_of(cell);
    uvec3 place = uvec3(voxel);
    uint turn = turn_of(place.xy) + turn_of(place.yz) + turn_of(place.zx);
    for (int i = 0; i < sides; ++i) {
        irradiance += side_irradiance(vec3(voxel) + 0.5, side, turn) / float(sides);
        side = -side;
    }
    imageStore(radiance, cell, vec4(surface.rgb / pi * irradiance * push.radiance_scale, 1) * surface.a);
}

void main() {
    if (gl_LocalInvocationIndex == 0u) occupied = 0u;
    barrier();
    for (uint place = gl_LocalInvocationIndex; place < uint(block_size); place += gl_WorkGroupSize.x) {
        ivec3 cell = cell_in_block(place);
        if (imageLoad(albedo, cell).a > 0.0) {
            places[atomicAdd(occupied, 1u)] = place;
        } else {
            imageStore(radiance, cell, vec4(0));
        }
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < occupied; i += gl_WorkGroupSize.x)
        reflect_from(cell_in_block(places[i]));
}
