#include "unit_shaders/raster_push.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
layout(location = 0) flat in uint instance[];
layout(location = 0) out vec2 uv;
layout(location = 1) flat out uint color_index;

void main() {
    for (int i = 0; i < 3; ++i) {
        gl_Layer = int(push.layer);
        gl_Position = gl_in[i].gl_Position;
        uv = gl_Position.xy;
        color_index = instance[i];
        EmitVertex();
    }
    EndPrimitive();
}
