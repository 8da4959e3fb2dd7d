// The finest anisotropic mip, as seen_along() of voxels/filter.glsl makes the others: from level 0, which has no
// directions, so that a voxel's eight children are read once for all six. Of all of the volume, or in the listed blocks.
#include "common/voxel_grid.glsl"

#define BLOCKS 2
#include "voxels/blocks.glsl"

layout(constant_id = 0) const bool listed = false;

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

vec4 over(vec4 front, vec4 back) { return front + (1.0 - front.a) * back; }

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (listed) {
        // Eight voxels of each of eight blocks.
        int number = int(gl_LocalInvocationIndex);
        voxel = first_of_block(group_number() * 8u + uint(number >> 3)) / 2 + (ivec3(number) >> ivec3(0, 1, 2) & 1);
    }
    int side = imageSize(coarser).y;
    if (!inside_grid(voxel, side)) return;

    ivec3 first = 2 * voxel;
    vec4 c0 = texelFetch(finer, first, 0), c1 = texelFetch(finer, first + ivec3(1, 0, 0), 0);
    vec4 c2 = texelFetch(finer, first + ivec3(0, 1, 0), 0), c3 = texelFetch(finer, first + ivec3(1, 1, 0), 0);
    vec4 c4 = texelFetch(finer, first + ivec3(0, 0, 1), 0), c5 = texelFetch(finer, first + ivec3(1, 0, 1), 0);
    vec4 c6 = texelFetch(finer, first + ivec3(0, 1, 1), 0), c7 = texelFetch(finer, first + ivec3(1, 1, 1), 0);

    precise vec4 seen[6];
    seen[0] = ((over(c0, c1) + over(c2, c3)) + over(c4, c5)) + over(c6, c7);
    seen[1] = ((over(c1, c0) + over(c3, c2)) + over(c5, c4)) + over(c7, c6);
    seen[2] = ((over(c0, c2) + over(c4, c6)) + over(c1, c3)) + over(c5, c7);
    seen[3] = ((over(c2, c0) + over(c6, c4)) + over(c3, c1)) + over(c7, c5);
    seen[4] = ((over(c0, c4) + over(c1, c5)) + over(c2, c6)) + over(c3, c7);
    seen[5] = ((over(c4, c0) + over(c5, c1)) + over(c6, c2)) + over(c7, c3);
    for (int direction = 0; direction < 6; ++direction) {
        imageStore(coarser, voxel + ivec3(direction * side, 0, 0), seen[direction] / 4.0);
    }
}
