// A triangle, as wide as high whatever the window's shape.
layout(push_constant) uniform Push { vec2 scale; } push;

layout(location = 0) out vec3 color;

const vec2 corners[3] = vec2[](vec2(-0.87, -0.75), vec2(0.87, -0.75), vec2(0.0, 0.75));
const vec3 colors[3] = vec3[](vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));

void main() {
    gl_Position = vec4(corners[gl_VertexIndex] * push.scale, 0.0, 1.0);
    color = colors[gl_VertexIndex];
}
