#include "test_rhi/pull.glsl"

struct Vertex {
    vec4 position;
    vec4 color;
};
layout(std430, binding = 0) readonly buffer Vertices { Vertex vertices[]; };

layout(location = 0) out vec4 color;

void main() {
    Vertex vertex = vertices[gl_VertexIndex];
    gl_Position = vertex.position + vec4(push.offset * float(gl_InstanceIndex), 0.0, 0.0);
    gl_PointSize = 1.0;
    color = vertex.color;
}
