// Vertices, indices and instances of a scene, as scene::GpuScene lays them out. The includer defines the bindings
// that it wants: GEOMETRY_VERTICES and GEOMETRY_INSTANCES, and GEOMETRY_INDICES where it pulls indices itself (a
// draw with an index buffer has the vertex in gl_VertexIndex). Spaces: object, and world (right-handed, metres).

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

// `precise`: every stage and pass that transforms a vertex gets the same bits.
vec3 world_from_object(uint instance, vec3 position) {
    vec4 p = vec4(position, 1);
    precise vec3 world = vec3(dot(instances.data[instance].world_from_object[0], p),
                              dot(instances.data[instance].world_from_object[1], p),
                              dot(instances.data[instance].world_from_object[2], p));
    return world;
}

// Not normalised.
vec3 world_direction(uint instance, vec3 direction) {
    return vec3(dot(instances.data[instance].world_from_object[0].xyz, direction),
                dot(instances.data[instance].world_from_object[1].xyz, direction),
                dot(instances.data[instance].world_from_object[2].xyz, direction));
}

// Not normalised; on the same side of the surface as in object space.
vec3 world_normal(uint instance, vec3 normal) {
    return vec3(dot(instances.data[instance].world_from_normal[0].xyz, normal),
                dot(instances.data[instance].world_from_normal[1].xyz, normal),
                dot(instances.data[instance].world_from_normal[2].xyz, normal));
}
