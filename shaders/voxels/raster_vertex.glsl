// Voxelization by the rasterizer (Crassin & Green, OpenGL Insights ch. 22), with no geometry shader.
//
// Crassin & Green draw a triangle once, along its dominant axis. Here it is drawn along all three: instance
// 3 i + axis projects instance i along `axis`, and each fragment marks the one voxel where the column's centre line
// meets the triangle. The voxels that the three axes' centre lines meet are exactly what separates the two sides of
// a surface for 6-connected paths (Laine 2013, A Topological Approach to Voxelization), because a path from one voxel
// centre to the next along an axis that crosses the surface crosses it inside one of the two voxels. No hole is left
// at an edge between two triangles either, since the rasterizer covers each column exactly once.

#define GEOMETRY_VERTICES 0
#define GEOMETRY_INDICES 1
#define GEOMETRY_INSTANCES 2
#include "common/geometry.glsl"
#include "common/voxel_grid.glsl"
#include "voxels/surface_share.glsl"
#include "voxels/voxelize_push.glsl"

#define VARYING out
#include "voxels/raster_varyings.glsl"

void main() {
    axis = uint(gl_InstanceIndex) % 3u;
    uint instance = push.first_instance + uint(gl_InstanceIndex) / 3u;
    uint first_corner = push.first_index + uint(gl_VertexIndex) / 3u * 3u;

    number = first_corner / 3u + instance * 0x9e3779b9u;

    VoxelGrid grid = VoxelGrid(push.grid_origin, push.voxels_per_metre);
    Vertex corner[3];
    vec3 p[3];
    for (int i = 0; i < 3; ++i) {
        corner[i] = fetch_vertex(indices.data[first_corner + uint(i)]);
        p[i] = grid_from_world(grid, world_from_object(instance, corner[i].position));
        // Cyclic order with the projection's axis last.
        p[i] = axis == 0u ? p[i].yzx : axis == 1u ? p[i].zxy : p[i];
    }
    precise vec3 normal = cross(p[1] - p[0], p[2] - p[0]);  // twice the area
    float doubled_area = length(normal);

    uint c = uint(gl_VertexIndex) % 3u;
    uv0 = corner[c].uv0;
    uv1 = corner[c].uv1;
    color = corner[c].color;
    anchor = p[0];
    vec3 front = normal / max(doubled_area, 1e-30) * instance_handedness(instance);
    facing = axis == 0u ? front.zxy : axis == 1u ? front.yzx : front;
    bool seen = is_seen(normal.z, doubled_area);
    extent = vec2(min(p[0].z, min(p[1].z, p[2].z)), max(p[0].z, max(p[1].z, p[2].z)));
    slope = seen ? -normal.xy / normal.z : vec2(0);
    share = seen ? share_of(normal.z, doubled_area) : 0.0;
    uv_per_voxel = seen ? uv_per_voxel_of(vec2[](corner[0].uv0, corner[1].uv0, corner[2].uv0),
                                          vec2[](corner[0].uv1, corner[1].uv1, corner[2].uv1), doubled_area)
                        : vec2(0);

    gl_Position = seen ? vec4(p[c].xy / float(push.resolution) * 2.0 - 1.0, 0.5, 1.0) : vec4(0, 0, 0, 1);
}
