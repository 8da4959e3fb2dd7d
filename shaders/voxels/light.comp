// What the analytic lights reach, as their shadow maps saw it.
//
// Every texel of a map carries a flux to the point that it sees, however that surface is inclined: irradiance times the
// texel's area across the ray. A voxel's sum of them, integers and hence the same in any order, is the flux that falls
// on it. A directional light's texels all carry the same: where it is the only light they are counted.
#define LIGHTS 0
#define SHADOW_MAPS 1
#define OCTREE_NODES 4
#define OCTREE_RECORDS 5
#include "common/lights.glsl"
#include "common/voxel_grid.glsl"
#include "voxels/flux.glsl"
#include "voxels/octree_cells.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(push_constant) uniform Push {
    mat4 world_from_clip;    // of the light's camera
    vec3 grid_origin;
    float voxels_per_metre;
    int light;
    int camera;
    float texel_area;        // across the camera's axis, m²; in perspective at a distance of 1 m
    float area_scale;        // counts per m²
    float flux_scale;        // counts per W
    int resolution;          // voxels a side
} push;

layout(binding = 2, r8) readonly uniform image3D area;  // encode_area of voxel faces; 0 where there are no surfaces
layout(binding = 3, r32ui) uniform uimage3D direct_flux;

// Evenly spread over [0, 1): what is rounded with it is right in the mean.
float dither(uvec3 v) {
    uint h = v.x * 0x9E3779B1u ^ v.y * 0x85EBCA77u ^ v.z * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return float((h ^ h >> 15) >> 8) / 16777216.0;
}

bool add_at(vec3 position, vec4 amount) {
    ivec3 voxel = ivec3(floor(position));
    if (!inside_grid(voxel, push.resolution)) return false;
    ivec3 cell = cell_of_voxel(voxel);
    if (cell.x < 0 || imageLoad(area, cell).r == 0.0) return false;
    imageAtomicAdd(direct_flux, flux_texel(cell, 0), uint(amount.x));
    if (several_lights) {
        imageAtomicAdd(direct_flux, flux_texel(cell, 1), uint(amount.y));
        imageAtomicAdd(direct_flux, flux_texel(cell, 2), uint(amount.z));
        imageAtomicAdd(direct_flux, flux_texel(cell, 3), uint(amount.w));
    }
    return true;
}

// Counts of lit area and of flux.
vec4 amount_of(vec3 world, ivec2 texel) {
    if (!several_lights) return vec4(1);
    Incident incident = incident_light(push.light, world);
    precise float area = push.texel_area;
    if (lights.position[push.light].w != 0) {
        precise vec3 offset = lights.position[push.light].xyz - world;
        precise float squared = (offset.x * offset.x + offset.y * offset.y) + offset.z * offset.z;
        vec3 axis = lights.camera_axis[push.camera].xyz;
        precise float along = (offset.x * axis.x + offset.y * axis.y) + offset.z * axis.z;
        // A texel's solid angle is its area times the cubed cosine to the axis; across the ray it has that times d².
        precise float cosine = along / sqrt(squared);
        area = area * cosine * cosine * cosine * squared;
    }
    precise float per_irradiance = area * push.flux_scale;
    precise vec4 amount = vec4(area * push.area_scale, incident.irradiance * per_irradiance);
    precise vec4 dithered = amount + dither(uvec3(texel, push.camera));
    return floor(dithered);
}

void main() {
    ivec2 size = textureSize(shadow_maps, 0).xy;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size))) return;
    float depth = texelFetch(shadow_maps, ivec3(texel, push.camera), 0).r;
    if (depth == 1.0) return;

    // Term by term and `precise`: which voxel a texel falls into must not hang on how a compiler orders a product.
    precise vec2 ndc = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
    mat4 m = push.world_from_clip;
    precise vec4 unscaled = m[0] * ndc.x + m[1] * ndc.y + m[2] * depth + m[3];
    precise vec3 world = unscaled.xyz / unscaled.w;
    precise vec3 position = (world - push.grid_origin) * push.voxels_per_metre;
    vec4 amount = amount_of(world, texel);

    // The part of a surface that cuts a voxel's corner may meet none of its centre lines, and a surface on a face may
    // have been voxelized to the other side of it. Its light goes to the nearest voxel that the surface does mark:
    // across the nearest face, the next, the last.
    if (add_at(position, amount)) return;
    vec3 offset = fract(position) - 0.5;
    vec3 nearness = abs(offset);
    for (int i = 0; i < 3; ++i) {
        float nearest = max(nearness.x, max(nearness.y, nearness.z));
        bvec3 across = nearness.x == nearest   ? bvec3(true, false, false)
                       : nearness.y == nearest ? bvec3(false, true, false)
                                               : bvec3(false, false, true);
        if (add_at(position + sign(offset) * vec3(across), amount)) return;
        nearness = mix(nearness, vec3(-1), across);
    }
}
