#version 450
layout(location = 0) in vec3 normal;
layout(location = 1) flat in vec3 color;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 world_normal;

void main() {
    albedo = vec4(color, 1);
    world_normal = vec4(normal, 1);
}
