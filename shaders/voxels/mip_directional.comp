// Anisotropic mips of a volume. The six values of a voxel lie in an atlas, one cube beside the other along x: toward +x,
// -x, +y, -y, +z, -z. Of all of the volume, or in the listed blocks from level 1 to 2.
#define BLOCKS 2
#include "voxels/blocks.glsl"

layout(constant_id = 0) const bool listed = false;

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

// The atlas' own texel: it says the direction too.
vec4 finer_texel(ivec3 texel, int direction) { return texelFetch(finer, texel, 0); }
#include "voxels/filter.glsl"

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    int side = imageSize(coarser).y;
    if (listed) {
        // A voxel of each of eight blocks for one direction, then for the next.
        int number = int(gl_LocalInvocationIndex);
        ivec3 voxel = first_of_block(group_number() * 8u + uint(number & 7)) / 4;
        if (voxel.x < 0 || number >= 48) return;
        texel = voxel + ivec3((number >> 3) * side, 0, 0);
    }
    if (any(greaterThanEqual(texel, imageSize(coarser)))) return;
    imageStore(coarser, texel, seen_along(texel.x / side, 2 * texel));
}
