// The bounce by cones.
const int gather_binding = 5;
#include "cones/gather.glsl"
#define BLOCK_MARKS 11
#include "bounce/bounce.glsl"

vec3 side_irradiance(vec3 position, vec3 side, uint turn) { return gather_irradiance(position, side, side, turn); }
