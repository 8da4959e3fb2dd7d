#include "shadow/interface.glsl"
#include "common/geometry.glsl"
#include "shadow/camera_block.glsl"

void main() {
    uint instance = draw.first_instance + gl_InstanceIndex;
    vec3 position = world_from_object(instance, fetch_position(gl_VertexIndex));
    gl_Position = transform(shadow.clip_from_world, vec4(position, 1));
}
