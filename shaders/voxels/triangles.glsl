// Voxelization by compute: the columns' centre lines that a triangle meets along the three axes, as in
// voxels/raster_vertex.glsl, but found here instead of by the rasterizer.
//
// Corners are snapped to 1/256 of a voxel, and whether a centre lies in the projected triangle is decided in whole
// numbers, without rounding. A centre on an edge belongs to the triangle that it would lie in if it were moved a
// little toward +x, and still less toward +y. So the triangles about an edge or a corner cover each column exactly once.
#define GEOMETRY_VERTICES 0
#define GEOMETRY_INDICES 1
#define GEOMETRY_INSTANCES 2
#include "common/geometry.glsl"
#include "voxels/surface_share.glsl"
#define MATERIAL 3
#define BASE_COLOR_TEXTURE 4
#include "voxels/fragment.glsl"

const int voxel_units = 256;
// Corners farther than this from the grid, in voxels, are moved to here: float32 places them to a quarter of a voxel.
const float farthest_corner = 2097152.0;

// What a small triangle is. At most so many columns are worth one thread's while, and with so short sides all of its
// arithmetic fits 32 bits.
const int small_columns = 128;  // a bit each of a uvec4
const int small_side = 63 * voxel_units;

struct Triangle {
    uint number;  // in all draws
    uint instance;
    uvec3 vertices;
    vec3 p[3];          // corners, grid space
    ivec3 snapped[3];   // corners in units of 1 / voxel_units of a voxel
    ivec3 first;        // along each axis, the least voxel whose centre the bounds have
    ivec3 size;         // how many there are
    vec3 normal;        // not normalised
    float doubled_area;
};

// By number among the draw's.
Triangle fetch_triangle(uint instance, uint triangle) {
    Triangle t;
    t.instance = push.first_instance + instance;
    uint first = push.first_index + triangle * 3u;
    t.number = first / 3u + t.instance * 0x9e3779b9u;
    t.vertices = uvec3(indices.data[first], indices.data[first + 1u], indices.data[first + 2u]);
    VoxelGrid grid = VoxelGrid(push.grid_origin, push.voxels_per_metre);
    for (int i = 0; i < 3; ++i) {
        t.p[i] = grid_from_world(grid, world_from_object(t.instance, fetch_position(t.vertices[i])));
        t.snapped[i] = ivec3(floor(clamp(t.p[i], -farthest_corner, farthest_corner) * float(voxel_units) + 0.5));
    }
    ivec3 low = min(t.snapped[0], min(t.snapped[1], t.snapped[2]));
    ivec3 high = max(t.snapped[0], max(t.snapped[1], t.snapped[2]));
    const int half_voxel = voxel_units / 2;
    t.first = max((low + (half_voxel - 1)) >> 8, ivec3(0));
    t.size = max(min((high - half_voxel) >> 8, ivec3(push.resolution - 1u)) - t.first + 1, ivec3(0));
    // Outside along one axis is outside of the grid.
    if (any(lessThan(high, ivec3(0))) || any(greaterThan(low, ivec3(push.resolution) * voxel_units))) t.size = ivec3(0);
    precise vec3 normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
    t.normal = normal;
    t.doubled_area = length(normal);
    return t;
}

// Columns in the bounds of the three projections.
int columns_of(Triangle t) { return t.size.x * t.size.y + t.size.y * t.size.z + t.size.z * t.size.x; }

// The two axes that follow `axis` in cyclic order, and then the axis itself.
vec3 projected(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
vec3 unprojected(vec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }
ivec2 across(ivec3 v, int axis) { return axis == 0 ? v.yz : axis == 1 ? v.zx : v.xy; }

// The triangle as columns along one axis see it.
struct Projection {
    ivec2 corner[3];  // counter-clockwise, in units of 1 / voxel_units of a voxel
    ivec2 first;      // the least column that may be covered
    ivec2 size;       // columns from there on
    bool seen;        // it may cover columns
};

Projection project(Triangle t, int axis) {
    float cosine = projected(t.normal, axis).z;
    Projection projection;
    bool turned = cosine < 0.0;
    projection.corner[0] = across(t.snapped[0], axis);
    ivec2 b = across(t.snapped[1], axis), c = across(t.snapped[2], axis);
    projection.corner[1] = turned ? c : b;
    projection.corner[2] = turned ? b : c;
    projection.first = across(t.first, axis);
    projection.size = across(t.size, axis);
    projection.seen = is_seen(cosine, t.doubled_area);
    return projection;
}

// An edge that holds the columns' centres which lie on it.
bool holds(ivec2 edge) { return edge.y < 0 || (edge.y == 0 && edge.x > 0); }

ivec2 center_of(ivec2 column) { return column * voxel_units + voxel_units / 2; }

// What fragments of a triangle need beside its place; read once for all of its columns.
struct Surface {
    vec2 uv0[3];
    vec2 uv1[3];
    vec4 color[3];
    vec2 uv_per_voxel;
    vec3 facing;
};

Surface fetch_surface(Triangle t) {
    Surface s;
    for (int i = 0; i < 3; ++i) {
        Vertex vertex = fetch_vertex(t.vertices[i]);
        s.uv0[i] = vertex.uv0;
        s.uv1[i] = vertex.uv1;
        s.color[i] = vertex.color;
    }
    s.uv_per_voxel = uv_per_voxel_of(s.uv0, s.uv1, t.doubled_area);
    s.facing = t.normal / t.doubled_area * instance_handedness(t.instance);
    return s;
}

// A column that the triangle covers.
void keep_column(Triangle t, Surface s, int axis, ivec2 column) {
    vec3 normal = projected(t.normal, axis);
    vec3 anchor = projected(t.p[0], axis);
    float z1 = projected(t.p[1], axis).z, z2 = projected(t.p[2], axis).z;
    vec2 slope = -normal.xy / normal.z;
    precise float plane = anchor.z + dot(slope, vec2(column) + 0.5 - anchor.xy);
    float height = clamp(plane, min(anchor.z, min(z1, z2)), max(anchor.z, max(z1, z2)));
    ivec3 voxel = ivec3(floor(unprojected(vec3(vec2(column), height), axis)));
    if (!inside_grid(voxel, int(push.resolution))) return;

    // Barycentric coordinates, up to a factor.
    vec2 to[3];
    for (int i = 0; i < 3; ++i) to[i] = vec2(across(t.snapped[i], axis) - center_of(column));
    vec3 inside = vec3(to[1].x * to[2].y - to[1].y * to[2].x, to[2].x * to[0].y - to[2].y * to[0].x,
                       to[0].x * to[1].y - to[0].y * to[1].x);
    vec3 weights = inside / (inside.x + inside.y + inside.z);
    VoxelFragment f;
    f.voxel = voxel;
    f.share = share_of(normal.z, t.doubled_area);
    f.uv0 = weights.x * s.uv0[0] + weights.y * s.uv0[1] + weights.z * s.uv0[2];
    f.uv1 = weights.x * s.uv1[0] + weights.y * s.uv1[1] + weights.z * s.uv1[2];
    f.color = weights.x * s.color[0] + weights.y * s.color[1] + weights.z * s.color[2];
    f.uv_per_voxel = s.uv_per_voxel;
    f.facing = s.facing;
    f.seed = fragment_seed(t.number, axis, column);
    keep_fragment(f);
}
