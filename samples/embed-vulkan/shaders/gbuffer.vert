#version 450
#extension GL_GOOGLE_include_directive : require
#include "boxes.glsl"

layout(location = 0) out vec3 normal;
layout(location = 1) flat out vec3 color;

// Six faces of two triangles.
void main() {
    int face = gl_VertexIndex / 6;
    int axis = face / 2;
    float side = face % 2 == 0 ? 1.0 : -1.0;
    vec2 corner = vec2[](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1))[gl_VertexIndex % 6];
    vec3 p = vec3(side, corner);
    vec3 n = vec3(side, 0, 0);
    p = axis == 0 ? p : axis == 1 ? p.zxy : p.yzx;
    n = axis == 0 ? n : axis == 1 ? n.zxy : n.yzx;

    Box box = boxes[gl_InstanceIndex];
    normal = n;
    color = box.color.rgb;
    gl_Position = frame.matrix * vec4(box.center.xyz + p * box.half_size.xyz, 1);
}
