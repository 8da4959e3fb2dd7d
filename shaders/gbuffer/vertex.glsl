#include "gbuffer/interface.glsl"
#include "common/geometry.glsl"
#include "common/camera.glsl"

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec4 out_tangent;  // w includes the instance's handedness
layout(location = 2) out vec4 out_uv;       // both sets
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out float out_handedness;

void main() {
    uint instance = draw.first_instance + gl_InstanceIndex;
    Vertex vertex = fetch_vertex(gl_VertexIndex);
    float handedness = instance_handedness(instance);
    out_normal = unit(world_normal(instance, vertex.normal));
    out_tangent = vec4(unit(world_direction(instance, vertex.tangent.xyz)), vertex.tangent.w * handedness);
    out_uv = vec4(vertex.uv0, vertex.uv1);
    out_color = vertex.color;
    out_handedness = handedness;
    gl_Position = clip_from_world(world_from_object(instance, vertex.position));
}
