// The vertex stage for fragments that look at the surface.
#include "shadow/interface.glsl"
#include "common/geometry.glsl"
#include "shadow/camera_block.glsl"

layout(location = 0) out vec4 out_uv;  // both sets
layout(location = 1) out float out_alpha;
layout(location = 2) out vec3 out_position;

void main() {
    uint instance = draw.first_instance + gl_InstanceIndex;
    Vertex vertex = fetch_vertex(gl_VertexIndex);
    out_position = world_from_object(instance, vertex.position);
    out_uv = vec4(vertex.uv0, vertex.uv1);
    out_alpha = vertex.color.a;
    gl_Position = transform(shadow.clip_from_world, vec4(out_position, 1));
}
