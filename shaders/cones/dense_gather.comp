// Irradiance at every pixel of the G-buffer by many rays through the finest voxels: what the voxels say, without what
// cones lose of it.
#define CAMERA 3
#include "common/camera.glsl"
#include "common/constants.glsl"
#include "common/frame.glsl"
#include "common/voxel_grid.glsl"
#define SKY_MAP 8
#include "sky/map.glsl"
#include "voxels/octree.glsl"
#include "voxels/walk.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool gather_emission = false;     // the emission volume's light
layout(constant_id = 1) const bool gather_environment = false;  // light from outside the grid
layout(constant_id = 2) const bool gather_sky = false;          // … that is a sky's, in place of a constant radiance

layout(push_constant) uniform Push {
    vec3 grid_origin;
    float voxels_per_metre;
    vec3 environment;      // radiance, W/m²/sr
    float radiance_unit;   // radiance = stored * radiance_unit, W/m²/sr
    float emission_unit;
    int resolution;        // voxels a side
    int rays;              // a pixel
    int first_ray;         // of this dispatch, which adds its rays to those before
    int end_ray;
    int first_row;
} push;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D normal_roughness;
layout(binding = 2) uniform sampler2D geometric_normal_occlusion;
// Level 0: values times opacity; a: opacity.
layout(binding = 4) uniform sampler3D radiance;
layout(binding = 5) uniform sampler3D emission;
layout(binding = 6) uniform usampler3D nodes;  // of an octree
layout(binding = 7, rgba32f) LUMO_READ_WRITE uniform image2D irradiance;

// A ray ends when less than this part of the light behind gets through.
const float min_transmittance = 1e-3;

// Where a voxel's values are; negative where it holds nothing.
ivec3 texel_of(ivec3 voxel) { return octree_levels > 0 ? voxel_texel(nodes, voxel) : voxel; }

float opacity_of(ivec3 voxel) {
    ivec3 texel = texel_of(voxel);
    return texel.x >= 0 ? texelFetch(radiance, texel, 0).a : 0.0;
}

vec3 trace_ray(vec3 origin, vec3 direction) {
    vec3 gathered = vec3(0);
    float transmittance = 1.0;
    Walk walk = start_walk(origin, direction, ivec3(floor(origin)));
    float entered = 0.0;
    bool inside = inside_grid(walk.voxel, push.resolution);
    while (transmittance >= min_transmittance && inside) {
        float opacity = opacity_of(walk.voxel);
        while (opacity == 0.0 && inside) {
            entered = leaves_voxel(walk);
            step_walk(walk);
            inside = inside_grid(walk.voxel, push.resolution);
            opacity = inside ? opacity_of(walk.voxel) : 0.0;
        }
        if (inside) {
            ivec3 texel = texel_of(walk.voxel);
            vec3 leaving = texelFetch(radiance, texel, 0).rgb * push.radiance_unit;
            if (gather_emission) leaving += texelFetch(emission, texel, 0).rgb * push.emission_unit;
            // Opacity is per voxel of path; what is opaque is so however short the path.
            float leaves = leaves_voxel(walk);
            float stopped = opacity < 1.0 ? 1.0 - pow(1.0 - opacity, leaves - entered) : 1.0;
            gathered += transmittance * leaving * (stopped / opacity);
            transmittance *= 1.0 - stopped;
            entered = leaves;
            step_walk(walk);
            inside = inside_grid(walk.voxel, push.resolution);
        }
    }
    if (gather_environment && transmittance >= min_transmittance)
        gathered += transmittance * (gather_sky ? sky_in_cone(direction, 0.0) : push.environment);
    return gathered;
}

// Where the rays of a surface start. In grid space.
vec3 start_of(vec3 position, vec3 geometric_normal, vec3 to_eye) {
    // A voxel that the surface's plane meets reaches at most this far from it: no ray meets the surface that it leaves.
    vec3 reach = abs(geometric_normal);
    // A little more, for what lies on the faces of voxels.
    vec3 origin = position + geometric_normal * (reach.x + reach.y + reach.z + 1e-2);
    // A surface nearby may have voxels there, too. What the eye sees is free toward the eye.
    const int most_steps = 4;
    Walk walk = start_walk(origin, to_eye, ivec3(floor(origin)));
    float way = 0.0;
    for (int i = 0; i < most_steps && inside_grid(walk.voxel, push.resolution) && opacity_of(walk.voxel) > 0.0; ++i) {
        way = leaves_voxel(walk) + 1e-3;
        step_walk(walk);
    }
    return origin + to_eye * way;
}

// This dispatch's part of the irradiance, W/m². The rays of a 4 x 4 block of pixels are together one spiral of golden
// angles, one in each of as many rings of equal cosine-weighted solid angle; each pixel has every 16th of them.
vec3 gather_irradiance(vec3 origin, vec3 geometric_normal, vec3 normal, uvec2 pixel) {
    const uint golden = 0x9E3779B9u;  // of a turn
    uint place = (pixel.y & 3u) << 2 | (pixel.x & 3u);
    mat3 frame = frame_about(normal);
    vec3 sum = vec3(0);
    for (int i = push.first_ray; i < push.end_ray; ++i) {
        uint index = uint(i) * 16u + place;
        float squared = (float(index) + 0.5) / float(push.rays * 16);
        // In whole numbers, which do not lose their last places as the index grows.
        float angle = 2.0 * pi * (float(index * golden >> 8u) / 16777216.0);
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
        vec3 normal = unit(texelFetch(normal_roughness, pixel, 0).xyz);
        geometric_normal = unit(geometric_normal);
        vec3 position = grid_from_world(VoxelGrid(push.grid_origin, push.voxels_per_metre), world);
        gathered = gather_irradiance(start_of(position, geometric_normal, direction_to_eye(world)),
                                     geometric_normal, normal, uvec2(pixel));
    }
    if (push.first_ray > 0) gathered += imageLoad(irradiance, pixel).rgb;
    imageStore(irradiance, pixel, vec4(gathered, 1));
}
