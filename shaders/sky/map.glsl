// The sky's light from a cone of directions, by its map. The includer defines SKY_MAP, its binding. Filled by
// lumo::sky::Sky::record_map.
#include "sky/octahedron.glsl"

// Level 0 has radiances, W/m²/sr, without the sun's disc; each other one its means over cones whose sine of half the
// half-angle is twice that of the level before. One texel deep, so that a volume can stand in for a sky that is not there.
layout(binding = SKY_MAP) uniform sampler3D sky_map;

const int sky_map_levels = 5;
const float sky_map_narrow = 0.007;  // what a texel of level 0 sees
const float sky_map_first = 0.0828;  // of level 1: 9.5 degrees to each side

float sky_map_cone(int level) { return sky_map_first * exp2(float(level - 1)); }

vec3 sky_map_at(vec2 place, int level) {
    return textureLod(sky_map, vec3(texel_centre_at(place, float(textureSize(sky_map, level).x)), 0.5), float(level)).rgb;
}

// Mean radiance over a cone about a direction of unit length.
vec3 sky_in_cone(vec3 direction, float tan_half_aperture) {
    float squared = tan_half_aperture * tan_half_aperture;
    float width = sqrt(0.5 * squared / (1.0 + squared + sqrt(1.0 + squared)));
    float level = width < sky_map_first
                      ? log2(max(width / sky_map_narrow, 1.0)) / log2(sky_map_first / sky_map_narrow)
                      : min(1.0 + log2(width / sky_map_first), float(sky_map_levels - 1));
    int finer = min(int(level), sky_map_levels - 2);
    vec2 place = place_of(direction);
    return max(mix(sky_map_at(place, finer), sky_map_at(place, finer + 1), level - float(finer)), vec3(0));
}
