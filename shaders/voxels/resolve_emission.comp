// Sums over the emitting surfaces to the mean emission of all surfaces in each voxel; 0 where
// there are none.
#include "common/voxel_grid.glsl"
#define SUMS 0
#define EXCHANGED 1
#define FLOATS 2
#define BLOCKS 6
#include "voxels/means.glsl"
#include "voxels/own_cell.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    float scale;  // stored = value * scale
} push;

layout(binding = 3, rgba8) readonly uniform image3D albedo;
layout(binding = 4, r8) readonly uniform image3D area;
layout(binding = 5) writeonly uniform image3D emission_volume;  // times opacity

void main() {
    ivec3 cell = own_cell();
    if (cell.x < 0 || any(greaterThanEqual(cell, imageSize(emission_volume)))) return;

    float opacity = imageLoad(albedo, cell).a;
    // Of what is masked out of the surfaces nothing emits either.
    float weight = opacity > 0.0 ? sum(cell, word_weight) : 0.0;
    vec3 mean = vec3(0);
    if (weight > 0.0) {
        // The rest of the voxel's surface is dark.
        mean = mean_value(cell, weight) * min(weight / weight_unit / decode_area(imageLoad(area, cell).r), 1.0);
    }
    imageStore(emission_volume, cell, vec4(mean * push.scale, 1) * opacity);
}
