// Irradiance by cones through the voxels (Crassin et al. 2011, Interactive Indirect Illumination Using Voxel Cone
// Tracing). Include once per program; takes bindings gather_binding to gather_binding + 5,
// 29, and that of voxels/sample.glsl.
#include "common/constants.glsl"
#include "common/frame.glsl"
#include "common/transform.glsl"
#include "common/voxel_grid.glsl"
#define SKY_MAP 29
#include "cones/emitter_block.glsl"
#include "sky/map.glsl"
#include "voxels/sample.glsl"

layout(constant_id = 20) const bool gather_reflected = true;     // the radiance volume's light, not its opacity alone
layout(constant_id = 21) const bool gather_emission = false;     // the emission volume's light
layout(constant_id = 22) const bool gather_environment = false;  // light from outside the grid
layout(constant_id = 29) const bool gather_sky = false;          // … that is a sky's, in place of a constant radiance
layout(constant_id = 28) const bool gather_occlusion = false;    // how near opacity is, in place of its light

const int max_cones = 32;
const int turns = 16;

// As voxels/sample.glsl reads them.
layout(binding = gather_binding) uniform sampler3D voxel_radiance;
layout(binding = gather_binding + 1) uniform sampler3D voxel_radiance_directions;
layout(binding = gather_binding + 2) uniform sampler3D voxel_emission;
layout(binding = gather_binding + 3) uniform sampler3D voxel_emission_directions;
layout(binding = gather_binding + 4, std140) uniform Gather {
    vec3 grid_origin;
    float voxels_per_metre;
    float radiance_unit;     // radiance = stored * radiance_unit, W/m²/sr
    float emission_unit;
    int cone_count;
    vec3 environment;        // radiance, W/m²/sr
    float resolution;        // voxels a side
    float occlusion_radius;  // voxels; what is as far occludes by half
    vec4 cones[turns * max_cones];  // set by set; xy: of the direction about +z; z: tangent of the half-angle; w: share
                                    // of the irradiance of a constant environment
} gather;
layout(binding = gather_binding + 5, std140) uniform Emitters { EMITTER_BLOCK } emitters;
#include "cones/emitter_light.glsl"

// The filter reaches a whole voxel to each side, voxels are as wide again, and every other one comes from the level
// above: voxels of a quarter of the cone's diameter see just the cone, and so not the surface that it starts from.
// Steps are as long as they are wide, so that a sample's opacity is a step's.
const float voxel_per_diameter = 0.25;

// A cone ends when less than this part of the light behind gets through.
const float min_transmittance = 0.05;

// Radiance from outside the grid.
vec3 environment_in_cone(vec3 direction, float tan_half_aperture) {
    return gather_sky ? sky_in_cone(direction, tan_half_aperture) : gather.environment;
}

struct Cone {
    vec3 origin;  // grid space
    vec3 direction;
    Facing facing;
    float voxel_per_distance;
    float dither;
};

// What a cone has met, what gets through that, and how far it is.
struct March {
    vec3 radiance;  // as stored
    float transmittance;
    float distance;  // voxels
};

// Which levels a part of the way reads. One after the other, each by a loop of its own: software drivers run both sides
// of a branch, and so would read every level's textures at every step.
const int finest = 0;
const int between = 1;
const int coarser = 2;

// The cone's way up to `end`, a distance.
void advance(inout March march, Cone cone, sampler3D base, sampler3D directions, int levels, float end) {
    vec3 position = cone.origin + cone.direction * march.distance;
    float margin = 0.0;
    // One exit: Mesa's GLSL compiler goes wrong on a loop that leaves its function from the middle. What lies at the
    // grid's side reaches over it, by the filter.
    while (march.distance < end && march.transmittance >= min_transmittance &&
           all(greaterThanEqual(position, vec3(-margin))) &&
           all(lessThanEqual(position, vec3(gather.resolution + margin)))) {
        float voxel = max(cone.voxel_per_distance * march.distance, 1.0);
        float lod = log2(voxel);
        if (whole_levels) lod = floor(lod + cone.dither);
        vec3 uvw = position / gather.resolution;
        vec4 stored;
        if (levels == finest) {
            stored = sample_finest(base, uvw);
        } else if (levels == between) {
            stored = sample_volume(base, directions, uvw, cone.facing, lod, gather.resolution);
        } else {
            stored = sample_coarser(base, directions, uvw, cone.facing, lod, gather.resolution);
        }
        // Occlusion is the irradiance of surfaces that are each as bright as their distance weighs.
        vec3 leaving =
            gather_occlusion ? vec3(stored.a / (1.0 + march.distance / gather.occlusion_radius)) : stored.rgb;
        march.radiance += march.transmittance * leaving;
        march.transmittance *= max(1.0 - stored.a, 0.0);
        if (gather_occlusion) margin = voxel;
        march.distance += voxel;
        position = cone.origin + cone.direction * march.distance;
    }
}

// All of a cone's way, from `start`, in voxels. Origin in grid space. `dither`: 0 to 1, with whole_levels: of cones whose
// mean is taken over all of them, which read one of the two levels beside theirs.
March march_through(sampler3D base, sampler3D directions, vec3 origin, vec3 direction, float tan_half_aperture,
                    float start, float dither) {
    float voxel_per_distance = max(2.0 * tan_half_aperture * voxel_per_diameter, 1e-6);
    Cone cone = Cone(origin, direction, facing_of(direction), voxel_per_distance, dither);
    March march = March(vec3(0), 1.0, start);
    const float everywhere = 1e30;
    if (whole_levels) {
        advance(march, cone, base, directions, finest, exp2(1.0 - dither) / voxel_per_distance);
    } else {
        advance(march, cone, base, directions, finest, 1.0 / voxel_per_distance);
        advance(march, cone, base, directions, between, 2.0 / voxel_per_distance);
    }
    advance(march, cone, base, directions, coarser, everywhere);
    return march;
}

// Reflected radiance from a cone, and that of the environment; or occlusion. As march_through.
vec3 trace_cone(vec3 origin, vec3 direction, float tan_half_aperture, float start, float dither) {
    March march = march_through(voxel_radiance, voxel_radiance_directions, origin, direction, tan_half_aperture, start,
                                dither);
    vec3 radiance = march.radiance;
    // The rest is as what was met.
    if (gather_occlusion && march.transmittance < min_transmittance) radiance /= 1.0 - march.transmittance;
    if (!gather_occlusion) radiance *= gather_reflected ? gather.radiance_unit : 0.0;
    if (gather_environment && march.transmittance >= min_transmittance)
        radiance += march.transmittance * environment_in_cone(direction, tan_half_aperture);
    return radiance;
}

// Emitted radiance from a cone. A march of its own, through the same opacities: where emitters are lit by one by one, cones
// have none of it to look for.
vec3 trace_emission(vec3 origin, vec3 direction, float tan_half_aperture, float start, float dither) {
    return gather.emission_unit * march_through(voxel_emission, voxel_emission_directions, origin, direction,
                                                tan_half_aperture, start, dither)
                                      .radiance;
}

// Which of 16 turns a place of a 4 x 4 pattern has: a Bayer matrix, so that neighbours differ most.
uint turn_of(uvec2 place) {
    uint x = place.x ^ place.y;
    return (x & 1u) << 3 | (place.y & 1u) << 2 | (x & 2u) | (place.y & 2u) >> 1;
}

// One of the cones of a place, in grid space.
struct PlacedCone {
    vec3 direction;
    float tangent;
    float weight;
    float dither;
};

PlacedCone place_cone(mat3 frame, uint turn, int i) {
    int set = whole_levels ? int(turn % uint(turns)) * gather.cone_count : 0;
    vec4 cone = gather.cones[set + i];
    vec3 direction = vec3(cone.xy, sqrt(max(1.0 - dot(cone.xy, cone.xy), 0.0)));
    // Another for each cone of a place, and each in one of the places.
    float dither = (float((turn + 5u * uint(i)) % uint(turns)) + 0.5) / float(turns);
    return PlacedCone(transform(frame, direction), cone.z, cone.w, dither);
}

// Irradiance on a surface, W/m². `position` in grid space. `geometric_normal` lifts the cones off the voxels of their
// own surface, `normal` is the hemisphere's axis; both unit length. `turn`: as turn_of.
vec3 gather_irradiance(vec3 position, vec3 geometric_normal, vec3 normal, uint turn) {
    // The surface's own voxels reach one voxel from it, the filter half of one more.
    vec3 origin = position + geometric_normal;
    mat3 frame = frame_about(normal);
    float emitted_part = gather_emission ? 1.0 - emitters.share : 0.0;
    int cones = gather_reflected || gather_environment ? gather.cone_count : 0;
    int emission_cones = emitted_part > 0.0 ? gather.cone_count : 0;
    vec3 sum = vec3(0);
    for (int i = 0; i < cones; ++i) {
        PlacedCone cone = place_cone(frame, turn, i);
        sum += cone.weight * trace_cone(origin, cone.direction, cone.tangent, 1.0, cone.dither);
    }
    for (int i = 0; gather_emission && i < emission_cones; ++i) {
        PlacedCone cone = place_cone(frame, turn, i);
        sum += cone.weight * emitted_part *
               trace_emission(origin, cone.direction, cone.tangent, 1.0, cone.dither);
    }
    sum *= pi;
    if (gather_emission) sum += emitter_irradiance(position, geometric_normal, normal, turn);
    return sum;
}

vec3 gather_position(vec3 world) {
    return grid_from_world(VoxelGrid(gather.grid_origin, gather.voxels_per_metre), world);
}
