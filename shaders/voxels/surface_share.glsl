// What a projection of a triangle along an axis stands for.

// Surface area of one of its fragments, in voxel faces; `cosine`, of the triangle's normal to the axis, times
// `doubled_area`. A fragment of this projection stands for 1 / |n_axis| of area. Weighting by |n_axis|² makes the three
// projections one estimate of the area: sum of n_axis² is 1.
float share_of(float cosine, float doubled_area) { return abs(cosine) / doubled_area; }

// A projection thinner than this covers no column's centre line, or none that another axis would not mark. Written so
// that what is not a number is not seen.
bool is_seen(float cosine, float doubled_area) { return abs(cosine) > 1e-4 * doubled_area && doubled_area < 1e30; }

// Length of a voxel in each uv set, by the area that a triangle of this area in voxel faces has in them.
vec2 uv_per_voxel_of(vec2 uv0[3], vec2 uv1[3], float doubled_area) {
    vec2 d0 = uv0[1] - uv0[0], e0 = uv0[2] - uv0[0];
    vec2 d1 = uv1[1] - uv1[0], e1 = uv1[2] - uv1[0];
    return sqrt(abs(vec2(d0.x * e0.y - d0.y * e0.x, d1.x * e1.y - d1.y * e1.x)) / doubled_area);
}
