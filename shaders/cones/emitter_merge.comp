// Eight cells to one of the next level, in order.
#include "common/voxel_grid.glsl"
#include "cones/emitter_cell.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    int finest;  // cells a side of the finest level
    int level;   // to fill, 1 and up
} push;

layout(binding = 0, std430) LUMO_READ_WRITE buffer Cells { EmitterCell data[]; } cells;

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    int side = push.finest >> push.level;
    if (!inside_grid(cell, side)) return;

    int first_child = first_cell(push.finest, push.level - 1);
    precise vec3 flux = vec3(0);
    precise float weight = 0.0;
    precise vec3 position = vec3(0);
    precise vec3 facing = vec3(0);
    for (int i = 0; i < 8; ++i) {
        EmitterCell child = cells.data[first_child + cell_index(2 * cell + (ivec3(i) >> ivec3(0, 1, 2) & 1), 2 * side)];
        float w = emitter_weight(child);
        flux += child.flux.rgb;
        weight += w;
        position += w * child.position_spread.xyz;
        facing += w * child.normal.xyz;
    }
    position = weight > 0.0 ? position / weight : vec3(0);
    facing = weight > 0.0 ? facing / weight : vec3(0);
    precise float spread = 0.0;
    for (int i = 0; i < 8; ++i) {
        EmitterCell child = cells.data[first_child + cell_index(2 * cell + (ivec3(i) >> ivec3(0, 1, 2) & 1), 2 * side)];
        precise vec3 offset = child.position_spread.xyz - position;
        spread += emitter_weight(child) * (child.position_spread.w +
                                           ((offset.x * offset.x + offset.y * offset.y) + offset.z * offset.z));
    }
    cells.data[first_cell(push.finest, push.level) + cell_index(cell, side)] =
        EmitterCell(vec4(position, weight > 0.0 ? spread / weight : 0.0), vec4(flux, 0), vec4(facing, 0));
}
