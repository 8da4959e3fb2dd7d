// Vertices, indices and instances of a scene, as scene::GpuScene lays them out. The includer defines the bindings
// that it wants: GEOMETRY_VERTICES and GEOMETRY_INSTANCES, and GEOMETRY_INDICES where it pulls indices itself (a
// draw with an index buffer has the vertex in gl_VertexIndex). Spaces: object, and world (right-handed, metres).
#include "common/transform.glsl"

struct StoredVertex {
    vec3 position;
    float uv0_x;
    vec3 normal;
    float uv0_y;
    vec4 tangent;
    vec2 uv1;
    uvec2 color;  // four 16-bit unorms
};

layout(std430, binding = GEOMETRY_VERTICES) readonly buffer Vertices {
    StoredVertex data[];
} vertices;

#ifdef GEOMETRY_INDICES
layout(std430, binding = GEOMETRY_INDICES) readonly buffer Indices {
    uint data[];
} indices;
#endif

// Rows of affine maps. The normals' map is the inverse transpose up to a positive factor, so that it stays right
// under mirrors and uneven scale; the w of its first row is -1 where the instance mirrors, else 1.
struct Instance {
    vec4 world_from_object[3];
    vec4 world_from_normal[3];
};

layout(std430, binding = GEOMETRY_INSTANCES) readonly buffer Instances {
    Instance data[];
} instances;

struct Vertex {
    vec3 position;
    vec3 normal;   // unit length
    vec4 tangent;  // w: bitangent = w * cross(normal, tangent.xyz)
    vec2 uv0;
    vec2 uv1;
    vec4 color;    // linear
};

Vertex fetch_vertex(uint index) {
    StoredVertex s = vertices.data[index];
    return Vertex(s.position, s.normal, s.tangent, vec2(s.uv0_x, s.uv0_y), s.uv1,
                  vec4(unpackUnorm2x16(s.color.x), unpackUnorm2x16(s.color.y)));
}

vec3 fetch_position(uint index) { return vertices.data[index].position; }

// -1 where the instance turns right hands into left ones (and the winding of triangles with them), else 1.
float instance_handedness(uint instance) { return instances.data[instance].world_from_normal[0].w; }

vec3 world_from_object(uint instance, vec3 position) {
    vec4 row0 = instances.data[instance].world_from_object[0];
    vec4 row1 = instances.data[instance].world_from_object[1];
    vec4 row2 = instances.data[instance].world_from_object[2];
    return transform_rows(row0, row1, row2, position) + vec3(row0.w, row1.w, row2.w);
}

// Not normalised.
vec3 world_direction(uint instance, vec3 direction) {
    return transform_rows(instances.data[instance].world_from_object[0],
                          instances.data[instance].world_from_object[1],
                          instances.data[instance].world_from_object[2], direction);
}

// Not normalised; on the same side of the surface as in object space.
vec3 world_normal(uint instance, vec3 normal) {
    return transform_rows(instances.data[instance].world_from_normal[0],
                          instances.data[instance].world_from_normal[1],
                          instances.data[instance].world_from_normal[2], normal);
}
