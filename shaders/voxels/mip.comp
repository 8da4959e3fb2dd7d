// Isotropic mips of a volume.
#include "common/voxel_grid.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

vec4 finer_texel(ivec3 texel, int direction) { return texelFetch(finer, texel, 0); }
#include "voxels/filter.glsl"

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (inside_grid(voxel, imageSize(coarser).x)) imageStore(coarser, voxel, mean_of(2 * voxel));
}
