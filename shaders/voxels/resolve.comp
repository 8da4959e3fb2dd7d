// Sums to means over the surfaces in each voxel.
#include "common/voxel_grid.glsl"
#include "voxels/accumulator.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) readonly uniform uimage3D sums;
layout(binding = 1, rgba8) writeonly uniform image3D albedo;  // a: opacity, 0 where empty
layout(binding = 2, r8) writeonly uniform image3D area;       // encode_area of voxel faces
layout(binding = 3, rgba8) writeonly uniform image3D normal;  // mean of the surfaces' normals, * 0.5 + 0.5

float sum(ivec3 cell, int word) { return float(imageLoad(sums, sum_texel(cell, word)).r); }

// Mean of three words of 8-bit values, 0 to 1.
vec3 mean(ivec3 cell, int word, float weight) {
    return vec3(sum(cell, word), sum(cell, word + 1), sum(cell, word + 2)) / (weight * 255.0);
}

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, imageSize(albedo)))) return;

    float weight = sum(cell, word_weight);
    bool occupied = weight > 0.0;
    // At least 1/255: a surface, however clear, is not an empty voxel.
    float opacity = translucent && occupied ? max(sum(cell, word_opacity) / weight, 1.0 / 255.0) : 1.0;
    imageStore(albedo, cell, occupied ? vec4(mean(cell, word_color, weight), opacity) : vec4(0));
    imageStore(area, cell, vec4(occupied ? encode_area(weight / weight_unit) : 0.0));
    if (normals) imageStore(normal, cell, vec4(occupied ? mean(cell, word_normal, weight) : vec3(0.5), 1));
}
