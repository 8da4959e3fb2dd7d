// Irradiance at every pixel of the G-buffer by many rays through the finest voxels: what the voxels say, without what
// cones lose of it.
#define CAMERA 3
#include "common/camera.glsl"
#include "common/constants.glsl"
#include "common/frame.glsl"
#include "common/voxel_grid.glsl"
#include "voxels/octree.glsl"
#include "voxels/walk.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool gather_emission = false;     // the emission volume's light
layout(constant_id = 1) const bool gather_environment = false;  // a constant radiance outside the grid

layout(push_constant) uniform Push {
    vec3 grid_origin;
    float voxels_per_metre;
    vec3 environment;      // radiance, W/m²/sr
    float radiance_unit;   // radiance = stored * radiance_unit, W/m²/sr
    float emission_unit;
    int resolution;        // voxels a side
    int rays;              // a pixel
    int first_row;         // of this dispatch, a multiple of 4
} push;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D normal_roughness;
layout(binding = 2) uniform sampler2D geometric_normal_occlusion;
// Level 0: values times opacity; a: opacity.
layout(binding = 4) uniform sampler3D radiance;
layout(binding = 5) uniform sampler3D emission;
layout(binding = 6) uniform usampler3D nodes;  // of an octree
layout(binding = 7, rgba32f) writeonly uniform image2D irradiance;

// A ray ends when less than this part of the light behind gets through.
const float min_transmittance = 1e-3;

vec3 trace_ray(vec3 origin, vec3 direction) {
    vec3 gathered = vec3(0);
    float transmittance = 1.0;
    float entered = 0.0;
    Walk walk = start_walk(origin, direction, ivec3(floor(origin)));
    while (transmittance >= min_transmittance && inside_grid(walk.voxel, push.resolution)) {
        float leaves = leaves_voxel(walk);
        ivec3 texel = octree_levels > 0 ? voxel_texel(nodes, walk.voxel) : walk.voxel;
        vec4 stored = texel.x >= 0 ? texelFetch(radiance, texel, 0) : vec4(0);
        if (stored.a > 0.0) {
            vec3 leaving = stored.rgb * push.radiance_unit;
            if (gather_emission) leaving += texelFetch(emission, texel, 0).rgb * push.emission_unit;
            // Opacity is per voxel of path; what is opaque is so however short the path.
            float opacity = stored.a < 1.0 ? 1.0 - pow(1.0 - stored.a, leaves - entered) : 1.0;
            gathered += transmittance * leaving * (opacity / stored.a);
            transmittance *= 1.0 - opacity;
        }
        entered = leaves;
        step_walk(walk);
    }
    if (gather_environment && transmittance >= min_transmittance) gathered += transmittance * push.environment;
    return gathered;
}

// Irradiance, W/m². The rays are a spiral of golden angles, one in each of as many rings of equal cosine-weighted solid
// angle. Each pixel of a 4 x 4 block turns it and moves it within its rings by other steps, so that the block's rays are
// spread as evenly as a pixel's.
vec3 gather_irradiance(vec3 position, vec3 geometric_normal, vec3 normal, uvec2 pixel) {
    const float golden = 0.618033989;
    uint place = (pixel.y & 3u) << 2 | (pixel.x & 3u);
    float ring = fract((float(place) + 0.5) * golden);
    float turn = (float(place) + 0.5) / 16.0;

    // A voxel that the surface's plane meets reaches at most this far from it: no ray meets the surface that it leaves.
    vec3 reach = abs(geometric_normal);
    vec3 origin = position + geometric_normal * (reach.x + reach.y + reach.z);

    mat3 frame = frame_about(normal);
    vec3 sum = vec3(0);
    for (int i = 0; i < push.rays; ++i) {
        float squared = (float(i) + ring) / float(push.rays);
        float angle = 2.0 * pi * fract(float(i) * golden + turn);
        float sine = sqrt(squared);
        vec3 direction = frame * vec3(sine * cos(angle), sine * sin(angle), sqrt(1.0 - squared));
        // Light from behind a triangle does not reach it, however its shading normal leans.
        if (dot(direction, geometric_normal) > 0.0) sum += trace_ray(origin, direction);
    }
    return sum * (pi / float(push.rays));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, push.first_row);
    if (any(greaterThanEqual(pixel, imageSize(irradiance)))) return;

    vec3 gathered = vec3(0);
    float pixel_depth = texelFetch(depth, pixel, 0).r;
    vec3 geometric_normal = texelFetch(geometric_normal_occlusion, pixel, 0).xyz;
    // Unlit surfaces have no normal.
    if (pixel_depth < 1.0 && geometric_normal != vec3(0)) {
        vec3 world = world_from_pixel(vec2(pixel) + 0.5, pixel_depth);
        gathered = gather_irradiance(grid_from_world(VoxelGrid(push.grid_origin, push.voxels_per_metre), world),
                                     unit(geometric_normal), unit(texelFetch(normal_roughness, pixel, 0).xyz),
                                     uvec2(pixel));
    }
    imageStore(irradiance, pixel, vec4(gathered, 1));
}
