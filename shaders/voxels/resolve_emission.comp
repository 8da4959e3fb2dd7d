// Sums over the emitting surfaces to the mean emission of all surfaces in each voxel.
#include "common/voxel_grid.glsl"
#include "voxels/accumulator.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) readonly uniform uimage3D sums;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, rgba8) writeonly uniform image3D emission;  // times opacity, in units of Push.emission_scale

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(emission).x)) return;

    float weight = float(imageLoad(sums, sum_texel(voxel, 3)).r);
    vec4 mean = vec4(0);
    if (weight > 0.0) {
        vec3 color = vec3(imageLoad(sums, sum_texel(voxel, 0)).r, imageLoad(sums, sum_texel(voxel, 1)).r,
                          imageLoad(sums, sum_texel(voxel, 2)).r) / (weight * 255.0);
        float emitting_part = weight / weight_unit / decode_area(imageLoad(area, voxel).r);
        mean = vec4(color * min(emitting_part, 1.0), 1.0);
    }
    imageStore(emission, voxel, mean);
}
