// A triangle a thread: the small ones are voxelized, the rest listed for voxels/large_triangles.glsl. The includer
// defines what voxels/fragment.glsl asks for, and LARGE_ARGUMENTS and LARGE_LIST, bindings.
#include "voxels/triangles.glsl"
#define LARGE_ACCESS
#include "voxels/large_list.glsl"

layout(binding = LARGE_LIST, std430) writeonly buffer LargeList {
    uint data[];
} large_list;

layout(local_size_x = 64) in;

void voxelize_along(Triangle t, Surface s, int axis, Projection projection) {
    ivec2 start = center_of(projection.first);
    ivec2 along[3];
    ivec3 row;
    for (int i = 0; i < 3; ++i) {
        ivec2 from = projection.corner[i] - start;
        along[i] = projection.corner[(i + 1) % 3] - projection.corner[i];
        row[i] = along[i].y * from.x - along[i].x * from.y - (holds(along[i]) ? 0 : 1);
    }
    ivec3 step_x = -ivec3(along[0].y, along[1].y, along[2].y) * voxel_units;
    ivec3 step_y = ivec3(along[0].x, along[1].x, along[2].x) * voxel_units;
    for (int y = 0; y < projection.size.y; ++y) {
        ivec3 edges = row;
        for (int x = 0; x < projection.size.x; ++x) {
            if ((edges.x | edges.y | edges.z) >= 0) {
                keep_column(t, s, axis, projection.first + ivec2(x, y), vec3(edges.yzx) + 1.0, projection.turned);
            }
            edges += step_x;
        }
        row += step_y;
    }
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
    if (columns > 0 && small) {
        Surface s = fetch_surface(t);
        for (int axis = 0; axis < 3; ++axis) voxelize_along(t, s, axis, project(t, axis));
    }
}

void main() {
    // The same for a whole group, which then reads an instance once.
    uint instance = gl_WorkGroupID.y + gl_WorkGroupID.z * gl_NumWorkGroups.y;
    if (instance < push.instances) {
        for (uint triangle = gl_GlobalInvocationID.x; triangle < push.triangles;
             triangle += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
            voxelize_triangle(instance, triangle);
        }
    }
}
