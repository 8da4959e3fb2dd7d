// The triangles that voxels/small_triangles.glsl listed: groups along z take an axis each, along y every so many tiles of
// 8 x 4 columns, along x every so many triangles.
#include "voxels/triangles.glsl"
#define LARGE_ACCESS readonly
#include "voxels/large_list.glsl"

layout(binding = LARGE_LIST, std430) readonly buffer LargeList {
    uint data[];
} large_list;

layout(local_size_x = 8, local_size_y = 4) in;

const ivec2 tile_size = ivec2(8, 4);

// Whether an edge has `to`, the way from its start to a point, on its left, or holds it. The products have up to 62 bits.
bool has_inside(ivec2 edge, ivec2 to) {
    int high_a, high_b, low_a, low_b;
    imulExtended(edge.x, to.y, high_a, low_a);
    imulExtended(edge.y, to.x, high_b, low_b);
    bool equal_bits = high_a == high_b && low_a == low_b;
    bool greater_bits = high_a > high_b || (high_a == high_b && uint(low_a) > uint(low_b));
    return greater_bits || (equal_bits && holds(edge));
}

void voxelize_along(Triangle t, int axis) {
    Projection projection = project(t, axis);
    ivec2 edges[3];
    for (int i = 0; i < 3; ++i) edges[i] = projection.corner[(i + 1) % 3] - projection.corner[i];
    ivec2 tiles = (projection.size + tile_size - 1) / tile_size;
    int end = projection.seen ? tiles.x * tiles.y : 0;
    int next = int(gl_WorkGroupID.y);
    if (next >= end) return;

    Surface s = fetch_surface(t);
    do {
        // To the next tile that may have something: of one that lies all outside of an edge, the column farthest inside
        // does.
        ivec2 corner;
        bool meets;
        do {
            int y = next / tiles.x;
            corner = projection.first + ivec2(next - y * tiles.x, y) * tile_size;
            meets = true;
            for (int i = 0; i < 3; ++i) {
                ivec2 farthest = corner + ivec2(edges[i].y < 0 ? tile_size.x : 0, edges[i].x > 0 ? tile_size.y : 0);
                meets = meets && has_inside(edges[i], center_of(farthest) - projection.corner[i]);
            }
            next += int(gl_NumWorkGroups.y);
        } while (!meets && next < end);

        ivec2 column = corner + ivec2(gl_LocalInvocationID.xy);
        bool covered = meets && all(lessThan(column, projection.first + projection.size));
        for (int i = 0; i < 3; ++i) {
            covered = covered && has_inside(edges[i], center_of(column) - projection.corner[i]);
        }
        if (covered) keep_column(t, s, axis, column);
    } while (next < end);
}

void main() {
    uint count = large_arguments.data[push.draw].count;
    // There are no more groups than triangles.
    uint entry = gl_WorkGroupID.x;
    do {
        uint number = large_list.data[push.first_large + entry];
        voxelize_along(fetch_triangle(number / push.triangles, number % push.triangles), int(gl_WorkGroupID.z));
        entry += gl_NumWorkGroups.x;
    } while (entry < count);
}
