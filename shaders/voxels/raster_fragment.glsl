// A column's centre line meets the triangle. The includer defines what voxels/fragment.glsl asks for.
#define VARYING in
#include "voxels/raster_varyings.glsl"
#define MATERIAL 3
#define BASE_COLOR_TEXTURE 4
#include "voxels/fragment.glsl"

void main() {
    // From the fragment's own centre and flat plane data: the drivers' interpolants differ in the last bits. A steep
    // plane leaves the triangle's own heights within the rasterizer's tolerance of an edge.
    precise float height = clamp(anchor.z + dot(slope, gl_FragCoord.xy - anchor.xy), extent.x, extent.y);
    ivec3 voxel = ivec3(floor(vec3(gl_FragCoord.xy, height)));
    voxel = axis == 0u ? voxel.zxy : axis == 1u ? voxel.yzx : voxel;
    if (!inside_grid(voxel, int(push.resolution))) return;
    keep_fragment(VoxelFragment(voxel, share, uv0, uv1, color, uv_per_voxel, facing,
                                fragment_seed(number, int(axis), ivec2(gl_FragCoord.xy))));
}
