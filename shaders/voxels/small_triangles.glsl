// A triangle a thread: the small ones are voxelized, the rest listed for voxels/large_triangles.glsl. The includer
// defines what voxels/fragment.glsl asks for, and LARGE_ARGUMENTS and LARGE_LIST, bindings.
#include "voxels/triangles.glsl"
#define LARGE_ACCESS
#include "voxels/large_list.glsl"

layout(binding = LARGE_LIST, std430) writeonly buffer LargeList {
    uint data[];
} large_list;

layout(local_size_x = 64) in;

// Which columns of a small triangle's bounds it covers: a bit each, along x first, row by row, axis by axis.
uvec4 covered_columns(Triangle t) {
    uvec4 covered = uvec4(0);
    int first = 0;
    for (int axis = 0; axis < 3; ++axis) {
        Projection projection = project(t, axis);
        ivec3 row, step_x, step_y;
        for (int i = 0; i < 3; ++i) {
            ivec2 along = projection.corner[(i + 1) % 3] - projection.corner[i];
            ivec2 to = center_of(projection.first) - projection.corner[i];
            row[i] = along.x * to.y - along.y * to.x - (holds(along) ? 0 : 1);
            step_x[i] = -along.y * voxel_units;
            step_y[i] = along.x * voxel_units;
        }
        int end = first + projection.size.x * projection.size.y;
        if (projection.seen && first < end) {
            ivec3 edges = row;
            int x = 0, place = first;
            do {
                uint bit = (edges.x | edges.y | edges.z) >= 0 ? 1u << (place & 31) : 0u;
                covered |= mix(uvec4(0), uvec4(bit), equal(ivec4(place >> 5), ivec4(0, 1, 2, 3)));
                ++x;
                bool row_ends = x == projection.size.x;
                row += row_ends ? step_y : ivec3(0);
                edges = row_ends ? row : edges + step_x;
                x = row_ends ? 0 : x;
                ++place;
            } while (place < end);
        }
        first = end;
    }
    return covered;
}

// A fragment of the column that such a bit stands for.
void keep_covered(Triangle t, Surface s, int number) {
    ivec3 counts = t.size.yzx * t.size.zxy;
    int axis = number < counts.x ? 0 : number < counts.x + counts.y ? 1 : 2;
    int place = number - (axis > 0 ? counts.x : 0) - (axis > 1 ? counts.y : 0);
    int width = across(t.size, axis).x;
    int y = int((float(place) + 0.5) / float(width));
    keep_column(t, s, axis, across(t.first, axis) + ivec2(place - y * width, y));
}

void voxelize_triangle(uint instance, uint triangle) {
    Triangle t = fetch_triangle(instance, triangle);
    int columns = columns_of(t);
    vec3 low = min(t.p[0], min(t.p[1], t.p[2])), high = max(t.p[0], max(t.p[1], t.p[2]));
    vec3 sides = (high - low) * float(voxel_units);
    bool small = columns <= small_columns && max(sides.x, max(sides.y, sides.z)) < float(small_side);
    if (columns > 0 && !small) {
        uint place = atomicAdd(large_arguments.data[push.draw].count, 1u);
        atomicMax(large_arguments.data[push.draw].groups_x, min(place + 1u, max_large_groups));
        large_list.data[push.first_large + place] = instance * push.triangles + triangle;
    }
    // Found before any fragment is kept, so that threads side by side all have one each time.
    uvec4 covered = uvec4(0);
    if (columns > 0 && small) covered = covered_columns(t);
    if (covered != uvec4(0)) {
        Surface s = fetch_surface(t);
        do {
            int word = covered.x != 0u ? 0 : covered.y != 0u ? 1 : covered.z != 0u ? 2 : 3;
            uint bits = word == 0 ? covered.x : word == 1 ? covered.y : word == 2 ? covered.z : covered.w;
            keep_covered(t, s, 32 * word + findLSB(bits));
            covered = mix(covered, uvec4(bits & (bits - 1u)), equal(ivec4(word), ivec4(0, 1, 2, 3)));
        } while (covered != uvec4(0));
    }
}

void main() {
    // The same for a whole group, which then reads an instance once.
    uint instance = gl_WorkGroupID.y + gl_WorkGroupID.z * gl_NumWorkGroups.y;
    uint triangle = gl_GlobalInvocationID.x;
    // Software drivers run a loop once more for nothing if its condition comes first.
    if (instance < push.instances && triangle < push.triangles) {
        do {
            voxelize_triangle(instance, triangle);
            triangle += gl_NumWorkGroups.x * gl_WorkGroupSize.x;
        } while (triangle < push.triangles);
    }
}
