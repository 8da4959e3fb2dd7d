// Radiance that leaves each voxel's surfaces when the sun lights them and they gather light from the other voxels:
// one more reflection than the volume that is gathered from holds.
#define FLUX 3
#include "voxels/reflect.glsl"
const int gather_binding = 5;
#include "cones/gather.glsl"

// A group takes a block of voxels and gathers for those that hold surfaces, which are few, side by side.
const int block_side = 8;
const int block_size = block_side * block_side * block_side;
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    vec3 flux;             // FluxUnits
    float lit_area;
    float lights;
    float radiance_scale;  // stored = radiance * radiance_scale
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, rgba8) readonly uniform image3D normal;
layout(binding = 4) writeonly uniform image3D radiance;  // times opacity; a: opacity

shared uint occupied;
shared uint places[block_size];

void reflect_from(ivec3 voxel) {
    vec4 surface = imageLoad(albedo, voxel);
    FluxUnits units = FluxUnits(push.flux, push.lit_area, push.lights);
    vec3 irradiance = direct_irradiance(units, voxel, imageLoad(area, voxel).r);

    vec3 facing = imageLoad(normal, voxel).xyz * 2.0 - 1.0;
    float agreement = length(facing);
    // Where a voxel's surfaces face opposite ways the mean says nothing, and both sides count.
    int sides = agreement > 0.25 ? 1 : 2;
    vec3 side = agreement > 0.25 ? facing / agreement : vec3(0, 1, 0);
    for (int i = 0; i < sides; ++i) {
        irradiance += gather_irradiance(vec3(voxel) + 0.5, side, side) / float(sides);
        side = -side;
    }
    imageStore(radiance, voxel, vec4(surface.rgb / pi * irradiance * push.radiance_scale, 1) * surface.a);
}

void main() {
    if (gl_LocalInvocationIndex == 0u) occupied = 0u;
    barrier();
    ivec3 corner = ivec3(gl_WorkGroupID) * block_side;
    for (uint place = gl_LocalInvocationIndex; place < uint(block_size); place += gl_WorkGroupSize.x) {
        ivec3 voxel = corner + (ivec3(place) >> ivec3(0, 3, 6) & block_side - 1);
        if (imageLoad(albedo, voxel).a > 0.0) {
            places[atomicAdd(occupied, 1u)] = place;
        } else {
            imageStore(radiance, voxel, vec4(0));
        }
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < occupied; i += gl_WorkGroupSize.x)
        reflect_from(corner + (ivec3(places[i]) >> ivec3(0, 3, 6) & block_side - 1));
}
