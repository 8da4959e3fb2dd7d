#version 450
layout(location = 0) out vec3 color;

// In the picture's lower left corner.
void main() {
    vec2 p = vec2[](vec2(-0.94, 0.92), vec2(-0.74, 0.92), vec2(-0.84, 0.6))[gl_VertexIndex];
    color = mat3(1)[gl_VertexIndex];
    gl_Position = vec4(p, 0, 1);
}
