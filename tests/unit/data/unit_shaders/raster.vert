#include "unit_shaders/raster_push.glsl"

layout(binding = 3, std430) readonly buffer Vertices { vec4 positions[]; };
layout(binding = 8) uniform sampler2D unused;

layout(location = 0) flat out uint instance;

void main() {
    instance = gl_InstanceIndex;
    gl_Position = positions[gl_VertexIndex] + vec4(push.offset, 0, 0);
    gl_PointSize = 2;
}
