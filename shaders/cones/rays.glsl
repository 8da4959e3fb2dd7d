// Irradiance by rays through the finest voxels, from one to the next: each is opaque, or as translucent as its opacity and
// the path in it say, and of one radiance. Include once per program, after cones/gather.glsl, whose block, volumes and
// emitters it reads. The includer defines BLOCK_MARKS, a binding.
#include "voxels/block_marks.glsl"
#include "voxels/walk.glsl"

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

// A ray on its way from voxel to voxel, and over blocks that hold nothing in one step. In grid space.
struct RayWalk {
    vec3 origin;
    vec3 direction;
    float entered;  // where along it it entered the voxel that it is in, in voxels
    Walk blocks;    // lengths in blocks
    Walk voxels;
    bool in_block;  // `voxels` is in the block
};

const float ray_block_side = float(1 << ray_block_log2);

RayWalk start_ray(vec3 origin, vec3 direction) {
    Walk blocks = start_walk(origin / ray_block_side, direction, ivec3(floor(origin)) >> ray_block_log2);
    return RayWalk(origin, direction, 0.0, blocks, blocks, false);
}

// On from the block that it is in.
void leave_block(inout RayWalk ray) {
    ray.entered = leaves_voxel(ray.blocks) * ray_block_side;
    step_walk(ray.blocks);
    ray.in_block = false;
}

// On from the voxel that it is in.
void leave_voxel(inout RayWalk ray) {
    ray.entered = leaves_voxel(ray.voxels);
    step_walk(ray.voxels);
    if (ray.voxels.voxel >> ray_block_log2 != ray.blocks.voxel) leave_block(ray);
}

// On to the next voxel that holds something, from the one that it is in; to the end of the grid or to `end`, in voxels,
// where there is none. Returns its opacity, or 0.
float find_voxel(inout RayWalk ray, float end) {
    int blocks = int(gather.resolution) >> ray_block_log2;
    float opacity = 0.0;
    bool on = ray.entered < end && inside_grid(ray.blocks.voxel, blocks);
    while (on && opacity == 0.0) {
        if (!ray.in_block) {
            bool occupied = block_occupied(ray.blocks.voxel);
            while (on && !occupied) {
                leave_block(ray);
                on = ray.entered < end && inside_grid(ray.blocks.voxel, blocks);
                occupied = on && block_occupied(ray.blocks.voxel);
            }
            precise vec3 place = ray.origin + ray.direction * ray.entered;
            ivec3 first = ray.blocks.voxel << ray_block_log2;
            ivec3 last = first + (1 << ray_block_log2) - 1;
            ray.voxels = start_walk(ray.origin, ray.direction, clamp(ivec3(floor(place)), first, last));
            ray.in_block = true;
        }
        while (on && opacity == 0.0 && ray.in_block) {
            opacity = opacity_of(ray.voxels.voxel);
            if (opacity == 0.0) leave_voxel(ray);
        }
        on = on && ray.entered < end && inside_grid(ray.blocks.voxel, blocks);
    }
    return on ? opacity : 0.0;
}

// The part of what comes from behind that the voxel that the ray is in stops. Opacity is per voxel of path; what is opaque
// is so however short the path.
float stopped_in_voxel(RayWalk ray, float opacity) {
    float path = max(leaves_voxel(ray.voxels) - ray.entered, 0.0);
    return opacity < 1.0 ? 1.0 - pow(1.0 - opacity, path) : 1.0;
}

// Radiance along a ray, W/m²/sr, with this part of what emits.
vec3 trace_ray(vec3 origin, vec3 direction, float emitted_part) {
    const float no_end = 1e30;
    vec3 gathered = vec3(0);
    float transmittance = 1.0;
    RayWalk ray = start_ray(origin, direction);
    float opacity;
    do {
        opacity = find_voxel(ray, no_end);
        if (opacity > 0.0) {
            ivec3 texel = texel_of(ray.voxels.voxel);
            vec3 leaving = vec3(0);
            if (gather_reflected) leaving = texelFetch(voxel_radiance, texel, 0).rgb * gather.radiance_unit;
            if (gather_emission)
                leaving += emitted_part * texelFetch(voxel_emission, texel, 0).rgb * gather.emission_unit;
            float stopped = stopped_in_voxel(ray, opacity);
            gathered += transmittance * leaving * (stopped / opacity);
            transmittance *= 1.0 - stopped;
            leave_voxel(ray);
        }
    } while (opacity > 0.0 && transmittance >= min_ray_transmittance);
    if (gather_environment && transmittance >= min_ray_transmittance)
        gathered += transmittance * environment_in_cone(direction, 0.0);
    return gathered;
}

// The part of the light between two points that nothing stops.
float ray_visibility(vec3 from, vec3 to) {
    vec3 path = to - from;
    float length = sqrt(inner(path, path));
    float transmittance = 1.0;
    RayWalk ray = start_ray(from, path / max(length, 1e-6));
    float opacity;
    do {
        opacity = find_voxel(ray, length);
        if (opacity > 0.0) {
            transmittance *= 1.0 - stopped_in_voxel(ray, opacity);
            leave_voxel(ray);
        }
    } while (opacity > 0.0 && transmittance >= min_ray_transmittance);
    return transmittance;
}

// Where the rays of a surface start: above every voxel that its plane meets, and where another surface has its voxels
// there, on along `free`, which leads out of them.
vec3 ray_start(vec3 position, vec3 geometric_normal, vec3 free) {
    // As far as such a voxel reaches from the plane.
    vec3 extent = abs(geometric_normal);
    // A little more, for what lies on the faces of voxels.
    vec3 origin = position + geometric_normal * (extent.x + extent.y + extent.z + 1e-2);
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

// A point of an emitter, of 16 that are spread over the disk of its extent, about where a path to it ends.
vec3 point_of_emitter(EmitterCell emitter, vec3 end, uint turn) {
    const float golden_angle = 2.39996323;
    float place = float(turn % uint(turns));
    float radius = sqrt(2.0 * emitter.position_spread.w * (place + 0.5) / float(turns));
    vec3 offset = radius * vec3(cos(golden_angle * place), sin(golden_angle * place), 0);
    return end + transform(frame_about(unit(end - cap_of(emitter).center)), offset);
}

// Irradiance from the emitters that are lit by one by one, W/m². `start`: where the surface's rays start. `turn`: as
// turn_of; each place of a pattern looks at other points of them, so that shadows have the penumbra of their extent.
vec3 emitter_irradiance_by_rays(vec3 position, vec3 start, vec3 normal, uint turn) {
    vec3 sum = vec3(0);
    for (int i = 0; gather_emission && i < emitters.count; ++i) {
        EmitterCell emitter = emitters.data[i];
        EmitterLight light = emitter_light(emitter, position, normal);
        if (light.irradiance != vec3(0))
            sum += light.irradiance * ray_visibility(start, point_of_emitter(emitter, light.end, turn));
    }
    return sum;
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
