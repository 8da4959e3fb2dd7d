// Sums to means over the surfaces in each voxel. What is empty is left as it is, 0.
#include "common/voxel_grid.glsl"
#define SUMS 0
#define EXCHANGED 1
#define FLOATS 2
#include "voxels/means.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(binding = 3, rgba8) writeonly uniform image3D albedo;  // a: opacity, 0 where empty
layout(binding = 4, r8) writeonly uniform image3D area;       // encode_area of voxel faces
layout(binding = 5, rgba8) writeonly uniform image3D normal;  // mean of the surfaces' normals, * 0.5 + 0.5

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, imageSize(albedo)))) return;

    float weight = sum(cell, word_weight);
    if (weight == 0.0) return;
    // At least 1/255: a surface, however clear, is not an empty voxel.
    float opacity = translucent ? max(sum(cell, word_opacity) / weight, 1.0 / 255.0) : 1.0;
    imageStore(albedo, cell, vec4(mean_value(cell, weight), opacity));
    imageStore(area, cell, vec4(encode_area(weight / weight_unit)));
    if (normals) imageStore(normal, cell, vec4(mean_color(cell, word_normal, weight), 1));
}
