// Two unit vectors that make a right-handed frame with a unit normal (Duff et al. 2017, Building an Orthonormal
// Basis, Revisited).
mat3 frame_about(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    precise float b = n.x * n.y * a;
    precise vec3 right = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
    precise vec3 up = vec3(b, s + n.y * n.y * a, -n.y);
    return mat3(right, up, n);
}
