// Directions on a square: the sphere as an octahedron, unfolded from +y (Praun and Hoppe 2003, Spherical Parametrization
// and Remeshing). The centres of the texels at the edge lie on it, where it meets itself, so that filtering is seamless.

// From +y in the middle; x and y in [-1, 1].
vec3 direction_at(vec2 place) {
    vec2 size = abs(place);
    float height = 1.0 - size.x - size.y;
    vec2 level = height >= 0.0 ? place : (1.0 - size.yx) * vec2(place.x < 0.0 ? -1.0 : 1.0, place.y < 0.0 ? -1.0 : 1.0);
    return normalize(vec3(level.x, height, level.y));
}

vec2 place_of(vec3 direction) {
    vec2 level = direction.xz / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    return direction.y >= 0.0 ? level
                              : (1.0 - abs(level.yx)) * vec2(level.x < 0.0 ? -1.0 : 1.0, level.y < 0.0 ? -1.0 : 1.0);
}

vec2 texel_centre_at(vec2 place, float side) { return (0.5 + 0.5 * place) * (side - 1.0) / side + 0.5 / side; }
