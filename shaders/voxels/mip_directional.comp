// Anisotropic mips (Crassin et al. 2011, section 7.2): what a ray that travels along one of six directions sees of
// eight children is the nearer four over the farther four. Colours are stored times opacity.
//
// The six values of a voxel lie in an atlas, one cube beside the other along x: toward +x, -x, +y, -y, +z, -z.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(texel, imageSize(coarser)))) return;

    int side = imageSize(coarser).y;
    int direction = texel.x / side;
    ivec3 first_child = 2 * texel;

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
        vec4 front = texelFetch(finer, pair + near, 0);
        sum += front + (1.0 - front.a) * texelFetch(finer, pair + far, 0);
    }
    imageStore(coarser, texel, sum / 4.0);
}
