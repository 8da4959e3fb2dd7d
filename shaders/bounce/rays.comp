// The bounce by rays.
const int gather_binding = 5;
#include "cones/gather.glsl"
#define BLOCK_MARKS 11
#include "bounce/bounce.glsl"
#include "cones/rays.glsl"

vec3 side_irradiance(vec3 position, vec3 side, uint turn) {
    vec3 start = ray_start(position, side, side);
    return rays_irradiance(start, side, side, turn, 0, push.rays, push.rays) +
           emitter_irradiance_by_rays(position, start, side, turn);
}
