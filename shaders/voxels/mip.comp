// Isotropic mips of a volume: of all of it, or in the listed blocks from level 0 to 1.
#include "common/voxel_grid.glsl"

#define BLOCKS 2
#include "voxels/blocks.glsl"

layout(constant_id = 0) const bool listed = false;

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

vec4 finer_texel(ivec3 texel, int direction) { return texelFetch(finer, texel, 0); }
#include "voxels/filter.glsl"

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (listed) {
        // Eight voxels of each of eight blocks.
        int number = int(gl_LocalInvocationIndex);
        voxel = first_of_block(group_number() * 8u + uint(number >> 3)) / 2 + (ivec3(number) >> ivec3(0, 1, 2) & 1);
    }
    if (inside_grid(voxel, imageSize(coarser).x)) imageStore(coarser, voxel, mean_of(2 * voxel));
}
