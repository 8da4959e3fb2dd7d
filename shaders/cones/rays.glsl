// Irradiance by rays through the finest voxels, from one to the next: each is opaque, or as translucent as its opacity and
// the path in it say, and of one radiance. Include once per program, after cones/gather.glsl, whose block, volumes and
// emitters it reads. The includer defines BLOCK_MARKS, a binding.
#include "voxels/walk.glsl"

// Where a dense volume holds something: not 0, a word for each block of 4 x 4 x 4 voxels, x fastest. Of an octree nothing
// is read: its nodes are such blocks.
layout(binding = BLOCK_MARKS, std430) readonly buffer BlockMarks { uint data[]; } block_marks;

const int ray_block_log2 = 2;
// A ray ends when less than this part of the light behind gets through.
const float min_ray_transmittance = 1e-3;

bool block_occupied(ivec3 block) {
    if (octree_levels > 0) return node_slot(voxel_nodes, block, 0) >= 0;
    int side = int(gather.resolution) >> ray_block_log2;
    return block_marks.data[(block.z * side + block.y) * side + block.x] != 0u;
}

// Where a voxel's values are; negative where it holds nothing.
ivec3 texel_of(ivec3 voxel) { return octree_levels > 0 ? voxel_texel(voxel_nodes, voxel) : voxel; }

float opacity_of(ivec3 voxel) {
    ivec3 texel = texel_of(voxel);
    return texel.x >= 0 ? texelFetch(voxel_radiance, texel, 0).a : 0.0;
}

// The walk through a block from where a ray enters it, after this length.
Walk enter_block(vec3 origin, vec3 direction, ivec3 block, float entered) {
    precise vec3 place = origin + direction * entered;
    ivec3 first = block << ray_block_log2;
    return start_walk(origin, direction, clamp(ivec3(floor(place)), first, first + (1 << ray_block_log2) - 1));
}

// Radiance along a ray, W/m²/sr, with this part of what emits. In grid space.
vec3 trace_ray(vec3 origin, vec3 direction, float emitted_part) {
    const float block_side = float(1 << ray_block_log2);
    int blocks = int(gather.resolution) >> ray_block_log2;
    vec3 gathered = vec3(0);
    float transmittance = 1.0;
    float entered = 0.0;
    // Its lengths are in blocks.
    Walk coarse = start_walk(origin / block_side, direction, ivec3(floor(origin)) >> ray_block_log2);
    bool inside = inside_grid(coarse.voxel, blocks);
    while (transmittance >= min_ray_transmittance && inside) {
        bool occupied = block_occupied(coarse.voxel);
        while (!occupied && inside) {
            entered = leaves_voxel(coarse) * block_side;
            step_walk(coarse);
            inside = inside_grid(coarse.voxel, blocks);
            occupied = inside && block_occupied(coarse.voxel);
        }
        if (inside) {
            Walk fine = enter_block(origin, direction, coarse.voxel, entered);
            bool in_block = true;
            do {
                float opacity = opacity_of(fine.voxel);
                while (opacity == 0.0 && in_block) {
                    entered = leaves_voxel(fine);
                    step_walk(fine);
                    in_block = fine.voxel >> ray_block_log2 == coarse.voxel;
                    opacity = in_block ? opacity_of(fine.voxel) : 0.0;
                }
                if (opacity > 0.0) {
                    ivec3 texel = texel_of(fine.voxel);
                    vec3 leaving = vec3(0);
                    if (gather_reflected) leaving = texelFetch(voxel_radiance, texel, 0).rgb * gather.radiance_unit;
                    if (gather_emission)
                        leaving += emitted_part * texelFetch(voxel_emission, texel, 0).rgb * gather.emission_unit;
                    // Opacity is per voxel of path; what is opaque is so however short the path.
                    float leaves = leaves_voxel(fine);
                    float stopped = opacity < 1.0 ? 1.0 - pow(1.0 - opacity, max(leaves - entered, 0.0)) : 1.0;
                    gathered += transmittance * leaving * (stopped / opacity);
                    transmittance *= 1.0 - stopped;
                    entered = leaves;
                    step_walk(fine);
                    in_block = fine.voxel >> ray_block_log2 == coarse.voxel;
                }
            } while (in_block && transmittance >= min_ray_transmittance);
            entered = leaves_voxel(coarse) * block_side;
            step_walk(coarse);
            inside = inside_grid(coarse.voxel, blocks);
        }
    }
    if (gather_environment && transmittance >= min_ray_transmittance)
        gathered += transmittance * environment_in_cone(direction, 0.0);
    return gathered;
}

// Where the rays of a surface start: above every voxel that it may lie in, `reach` times as far from it as a voxel that
// its plane meets, at most, reaches; and where another surface has its voxels there, on along `free`, which leads out
// of them.
vec3 ray_start(vec3 position, vec3 geometric_normal, vec3 free, float reach) {
    vec3 extent = abs(geometric_normal);
    // A little more, for what lies on the faces of voxels.
    vec3 origin = position + geometric_normal * (reach * (extent.x + extent.y + extent.z) + 1e-2);
    const int most_steps = 4;
    Walk walk = start_walk(origin, free, ivec3(floor(origin)));
    float way = 0.0;
    for (int i = 0; i < most_steps && inside_grid(walk.voxel, int(gather.resolution)) && opacity_of(walk.voxel) > 0.0;
         ++i) {
        way = leaves_voxel(walk) + 1e-3;
        step_walk(walk);
    }
    return origin + free * way;
}

// The part of the irradiance, W/m², that rays `first` to before `end` of `count` have. The rays of the 16 places of a
// pattern are together one spiral of golden angles about the normal, one in each of as many rings of equal cosine-weighted
// solid angle; each place has every 16th of them. `turn`: as turn_of.
vec3 rays_irradiance(vec3 origin, vec3 geometric_normal, vec3 normal, uint turn, int first, int end, int count) {
    const uint golden = 0x9E3779B9u;  // of a turn
    mat3 frame = frame_about(normal);
    float emitted_part = gather_emission ? 1.0 - emitters.share : 0.0;
    vec3 sum = vec3(0);
    for (int i = first; i < end; ++i) {
        uint index = uint(i) * uint(turns) + turn % uint(turns);
        float squared = (float(index) + 0.5) / float(count * turns);
        // In whole numbers, which do not lose their last places as the index grows.
        float angle = 2.0 * pi * (float(index * golden >> 8u) / 16777216.0);
        float sine = sqrt(squared);
        vec3 direction = transform(frame, vec3(sine * cos(angle), sine * sin(angle), sqrt(1.0 - squared)));
        // Light from behind a triangle does not reach it, however its shading normal leans.
        if (dot(direction, geometric_normal) > 0.0) sum += trace_ray(origin, direction, emitted_part);
    }
    return sum * (pi / float(count));
}
