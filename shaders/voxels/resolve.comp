// Sums to means over the surfaces in each voxel.
#include "common/voxel_grid.glsl"
#include "voxels/accumulator.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) readonly uniform uimage3D sums;
layout(binding = 1, rgba8) writeonly uniform image3D albedo;  // a: opacity, 0 where empty
layout(binding = 2, r8) writeonly uniform image3D area;       // encode_area of voxel faces

float sum(ivec3 voxel, int word) {
    return float(imageLoad(sums, sum_texel(voxel, word)).r);
}

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(albedo).x)) return;

    float weight = sum(voxel, 3);
    vec4 mean = vec4(0);
    float encoded = 0.0;
    if (weight > 0.0) {
        vec3 color = vec3(sum(voxel, 0), sum(voxel, 1), sum(voxel, 2)) / (weight * 255.0);
        // At least 1/255: a surface, however clear, is not an empty voxel.
        float opacity = translucent ? max(sum(voxel, 4) / weight, 1.0 / 255.0) : 1.0;
        mean = vec4(color, opacity);
        encoded = encode_area(weight / weight_unit);
    }
    imageStore(albedo, voxel, mean);
    imageStore(area, voxel, vec4(encoded));
}
