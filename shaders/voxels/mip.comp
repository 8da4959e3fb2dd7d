// Isotropic mips: each voxel is the mean of its eight children (Crassin et al. 2011). Colours are stored times
// opacity, so the mean is right for both.
#include "common/voxel_grid.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(coarser).x)) return;

    precise vec4 sum = vec4(0);
    for (int child = 0; child < 8; ++child) {
        sum += texelFetch(finer, voxel * 2 + (ivec3(child) >> ivec3(0, 1, 2) & 1), 0);
    }
    imageStore(coarser, voxel, sum / 8.0);
}
