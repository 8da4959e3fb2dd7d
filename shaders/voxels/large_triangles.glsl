// The triangles that voxels/small_triangles.glsl listed: groups along z take an axis each, along y every so many tiles of
// 8 x 8 columns, along x every so many triangles.
#include "voxels/triangles.glsl"
#define LARGE_ACCESS readonly
#include "voxels/large_list.glsl"

layout(binding = LARGE_LIST, std430) readonly buffer LargeList {
    uint data[];
} large_list;

layout(local_size_x = 8, local_size_y = 8) in;

const int tile_side = 8;

// Whether an edge has `to`, the way from its start to a point, on its left, or holds it. The products have up to 62 bits.
bool has_inside(ivec2 edge, ivec2 to) {
    int high_a, high_b, low_a, low_b;
    imulExtended(edge.x, to.y, high_a, low_a);
    imulExtended(edge.y, to.x, high_b, low_b);
    bool equal_bits = high_a == high_b && low_a == low_b;
    bool greater_bits = high_a > high_b || (high_a == high_b && uint(low_a) > uint(low_b));
    return greater_bits || (equal_bits && holds(edge));
}

void main() {
    int axis = int(gl_WorkGroupID.z);
    uint count = large_arguments.data[push.draw].count;
    for (uint entry = gl_WorkGroupID.x; entry < count; entry += gl_NumWorkGroups.x) {
        uint number = large_list.data[push.first_large + entry];
        Triangle t = fetch_triangle(number / push.triangles, number % push.triangles);
        Projection projection = project(t, axis);
        Surface s = fetch_surface(t);
        ivec2 edges[3];
        for (int i = 0; i < 3; ++i) edges[i] = projection.corner[(i + 1) % 3] - projection.corner[i];

        ivec2 tiles = (projection.size + tile_side - 1) / tile_side;
        for (int tile = int(gl_WorkGroupID.y); tile < tiles.x * tiles.y; tile += int(gl_NumWorkGroups.y)) {
            ivec2 corner = projection.first + ivec2(tile % tiles.x, tile / tiles.x) * tile_side;
            // Of a tile that lies all outside of an edge, the column farthest inside does.
            bool meets = true;
            for (int i = 0; i < 3; ++i) {
                ivec2 farthest = corner + ivec2(edges[i].y < 0 ? tile_side : 0, edges[i].x > 0 ? tile_side : 0);
                meets = meets && has_inside(edges[i], center_of(farthest) - projection.corner[i]);
            }
            ivec2 column = corner + ivec2(gl_LocalInvocationID.xy);
            if (!meets || any(greaterThanEqual(column, projection.first + projection.size))) continue;

            bool covered = true;
            vec3 inside;
            for (int i = 0; i < 3; ++i) {
                ivec2 to = center_of(column) - projection.corner[i];
                covered = covered && has_inside(edges[i], to);
                inside[(i + 2) % 3] = float(edges[i].x) * float(to.y) - float(edges[i].y) * float(to.x);
            }
            if (covered) keep_column(t, s, axis, column, inside, projection.turned);
        }
    }
}
