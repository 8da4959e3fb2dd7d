// The emitting voxels of each cell of the finest level. One invocation adds up a cell in order, so that both APIs
// get the same sums.
#include "common/voxel_grid.glsl"
#include "cones/emitter_cell.glsl"
#define OCTREE_NODES 5
#define OCTREE_RECORDS 6
#include "voxels/octree_cells.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    int side;  // of the grid, in cells
    int size;  // of a cell, in voxels
} push;

layout(binding = 0) uniform sampler3D emission;  // level 0, times opacity
layout(binding = 1) uniform sampler3D albedo;    // a: opacity
layout(binding = 2) uniform sampler3D area;
layout(binding = 3) uniform sampler3D normal;
layout(binding = 4, std430) writeonly buffer Cells { EmitterCell data[]; } cells;

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(cell, push.side)) return;

    int size = push.size;
    vec3 center = (vec3(cell) + 0.5) * float(size);
    precise vec3 flux = vec3(0);
    precise float weight = 0.0;
    precise vec4 moments = vec4(0);  // xyz: weight times offset from the center; w: times its square
    precise vec3 facing = vec3(0);
    for (int z = 0; z < size; ++z) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                ivec3 voxel = cell * size + ivec3(x, y, z);
                ivec3 surface = cell_of_voxel(voxel);
                if (surface.x < 0) continue;
                vec3 emitted = texelFetch(emission, octree_levels > 0 ? voxel_texel(octree_nodes, voxel) : voxel, 0).rgb;
                if (emitted == vec3(0)) continue;
                precise vec3 part =
                    emitted * (decode_area(texelFetch(area, surface, 0).r) / texelFetch(albedo, surface, 0).a);
                precise float w = (part.r + part.g) + part.b;
                precise vec3 offset = (vec3(voxel) + 0.5) - center;
                precise vec3 n = texelFetch(normal, surface, 0).xyz * 2.0 - 1.0;
                flux += part;
                weight += w;
                moments.xyz += w * offset;
                // A voxel's surface spreads about its centre as a unit square does.
                moments.w += w * ((offset.x * offset.x + offset.y * offset.y) + offset.z * offset.z + 1.0 / 6.0);
                facing += w * n;
            }
        }
    }
    precise vec3 mean = weight > 0.0 ? moments.xyz / weight : vec3(0);
    precise float squares = weight > 0.0 ? moments.w / weight : 0.0;
    precise float spread = squares - ((mean.x * mean.x + mean.y * mean.y) + mean.z * mean.z);
    cells.data[cell_index(cell, push.side)] =
        EmitterCell(vec4(center + mean, max(spread, 0.0)), vec4(flux, 0),
                    vec4(weight > 0.0 ? facing / weight : vec3(0), 0));
}
