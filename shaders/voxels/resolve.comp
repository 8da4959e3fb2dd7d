// Sums to means over the surfaces in each voxel; 0 where there are none.
#include "common/voxel_grid.glsl"
#define SUMS 0
#define EXCHANGED 1
#define FLOATS 2
#define BLOCKS 6
#include "voxels/means.glsl"
#include "voxels/own_cell.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 3, rgba8) writeonly uniform image3D albedo;  // a: opacity, 0 where empty
layout(binding = 4, r8) writeonly uniform image3D area;       // encode_area of voxel faces
layout(binding = 5, rgba8) writeonly uniform image3D normal;  // mean of the surfaces' normals, * 0.5 + 0.5

void main() {
    ivec3 cell = own_cell();
    if (cell.x < 0 || any(greaterThanEqual(cell, imageSize(albedo)))) return;

    float weight = sum(cell, word_weight);
    bool empty = weight == 0.0;
    // At least 1/255: a surface, however clear, is not an empty voxel.
    float opacity = translucent ? max(sum(cell, word_opacity) / weight, 1.0 / 255.0) : 1.0;
    imageStore(albedo, cell, empty ? vec4(0) : vec4(mean_value(cell, weight), opacity));
    imageStore(area, cell, vec4(empty ? 0.0 : encode_area(weight / weight_unit)));
    if (normals) imageStore(normal, cell, empty ? vec4(0) : vec4(mean_color(cell, word_normal, weight), 1));
}
