// Products with the order of their sums written down, and unit vectors: compilers differ in what they make of the
// operators and of normalize(), by the last bit of a depth or a position, and a comparison makes a pixel of it.

vec4 transform(mat4 m, vec4 v) {
    precise vec4 product = ((m[0] * v.x + m[1] * v.y) + m[2] * v.z) + m[3] * v.w;
    return product;
}

vec3 transform(mat3 m, vec3 v) {
    precise vec3 product = (m[0] * v.x + m[1] * v.y) + m[2] * v.z;
    return product;
}

// The matrix is given by rows.
vec3 transform_rows(vec4 row0, vec4 row1, vec4 row2, vec3 v) {
    precise vec3 product = (vec3(row0.x, row1.x, row2.x) * v.x + vec3(row0.y, row1.y, row2.y) * v.y) +
                           vec3(row0.z, row1.z, row2.z) * v.z;
    return product;
}

float inner(vec3 a, vec3 b) {
    precise float product = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return product;
}

// v is far from 0 and infinity: its squared length is a normal float.
vec3 unit(vec3 v) { return v * inversesqrt(inner(v, v)); }
