// Anisotropic mips of a volume. The six values of a voxel lie in an atlas, one cube beside the other along x: toward +x,
// -x, +y, -y, +z, -z.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0) uniform sampler3D finer;
layout(binding = 1) writeonly uniform image3D coarser;

// The atlas' own texel: it says the direction too.
vec4 finer_texel(ivec3 texel, int direction) { return texelFetch(finer, texel, 0); }
#include "voxels/filter.glsl"

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(texel, imageSize(coarser)))) return;
    imageStore(coarser, texel, seen_along(texel.x / imageSize(coarser).y, 2 * texel));
}
