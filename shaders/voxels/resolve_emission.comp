// Sums over the emitting surfaces to the mean emission of all surfaces in each voxel.
#include "common/voxel_grid.glsl"
#include "voxels/accumulator.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) readonly uniform uimage3D sums;
layout(binding = 1, rgba8) readonly uniform image3D albedo;
layout(binding = 2, r8) readonly uniform image3D area;
layout(binding = 3) writeonly uniform image3D emission;  // times opacity, in units of emission_scale

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, imageSize(emission)))) return;

    float weight = float(imageLoad(sums, sum_texel(cell, word_weight)).r);
    vec3 mean = vec3(0);
    if (weight > 0.0) {
        mean = vec3(imageLoad(sums, sum_texel(cell, word_color)).r, imageLoad(sums, sum_texel(cell, word_color + 1)).r,
                    imageLoad(sums, sum_texel(cell, word_color + 2)).r) / (weight * 255.0);
        // The rest of the voxel's surface is dark.
        mean *= min(weight / weight_unit / decode_area(imageLoad(area, cell).r), 1.0);
    }
    imageStore(emission, cell, vec4(mean, 1) * imageLoad(albedo, cell).a);
}
