// The voxels themselves, as the camera sees them: the first occupied one on each pixel's ray.
#define CAMERA 2
#include "common/camera.glsl"
#include "common/voxel_grid.glsl"
#include "voxels/octree.glsl"
#include "voxels/walk.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    vec3 grid_origin;
    float voxels_per_metre;
    float radiance_unit;
    float emission_unit;  // 0: there is no emission
    int resolution;       // voxels a side
} push;

layout(binding = 0) uniform sampler3D radiance;
layout(binding = 1) uniform sampler3D emission;
layout(binding = 3, rgba32f) writeonly uniform image2D layer;
layout(binding = 4) uniform usampler3D nodes;  // of an octree

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(layer)))) return;

    VoxelGrid grid = VoxelGrid(push.grid_origin, push.voxels_per_metre);
    int resolution = push.resolution;
    // `precise`, and no unit vector: which voxel a ray enters next must not hang on how a compiler rounds.
    precise vec3 near = grid_from_world(grid, world_from_pixel(vec2(pixel) + 0.5, 0.0));
    precise vec3 far = grid_from_world(grid, world_from_pixel(vec2(pixel) + 0.5, 1.0));
    precise vec3 direction = far - near;
    // An axis along which the ray does not move is never the next one.
    direction = mix(direction, vec3(1e-12), equal(direction, vec3(0)));

    precise vec3 to_low = (vec3(0) - near) / direction;
    precise vec3 to_high = (vec3(resolution) - near) / direction;
    vec3 entries = min(to_low, to_high), exits = max(to_low, to_high);
    float enter = max(max(entries.x, max(entries.y, entries.z)), 0.0);
    float leave = min(exits.x, min(exits.y, exits.z));

    vec3 seen = vec3(0);
    if (enter < leave) {
        precise vec3 entry = near + direction * enter;
        Walk walk = start_walk(near, direction, clamp(ivec3(floor(entry)), ivec3(0), ivec3(resolution - 1)));
        for (int i = 0; i < 3 * 1024 && inside_grid(walk.voxel, resolution); ++i) {
            ivec3 texel = octree_levels > 0 ? voxel_texel(nodes, walk.voxel) : walk.voxel;
            vec4 stored = texel.x >= 0 ? texelFetch(radiance, texel, 0) : vec4(0);
            if (stored.a > 0.0) {
                seen = stored.rgb / stored.a * push.radiance_unit;
                if (push.emission_unit > 0.0)
                    seen += texelFetch(emission, texel, 0).rgb / stored.a * push.emission_unit;
                break;
            }
            step_walk(walk);
        }
    }
    imageStore(layer, pixel, vec4(seen, 1));
}
