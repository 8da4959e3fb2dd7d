// A voxel from its eight children (Crassin et al. 2011), whichever storage they lie in. Colours are stored times opacity.
// The includer defines, before this file, `vec4 finer_texel(ivec3 texel, int direction)`: a child, as a ray that travels
// in one of six directions sees it: toward +x, -x, +y, -y, +z, -z.

// Isotropic: the mean.
vec4 mean_of(ivec3 first_child) {
    precise vec4 sum = vec4(0);
    for (int child = 0; child < 8; ++child) {
        sum += finer_texel(first_child + (ivec3(child) >> ivec3(0, 1, 2) & 1), 0);
    }
    return sum / 8.0;
}

// Anisotropic (section 7.2): the nearer four over the farther four.
vec4 seen_along(int direction, ivec3 first_child) {
    int axis = direction >> 1;
    ivec3 deeper = ivec3(axis == 0, axis == 1, axis == 2);
    ivec3 right = deeper.zxy;
    ivec3 up = deeper.yzx;
    // Against the axis the far child is the first one.
    ivec3 near = (direction & 1) == 0 ? ivec3(0) : deeper;
    ivec3 far = deeper - near;

    precise vec4 sum = vec4(0);
    for (int i = 0; i < 4; ++i) {
        ivec3 pair = first_child + (i & 1) * right + (i >> 1) * up;
        vec4 front = finer_texel(pair + near, direction);
        sum += front + (1.0 - front.a) * finer_texel(pair + far, direction);
    }
    return sum / 4.0;
}
