// Included by programs of unit_shaders/.
struct Light {
    vec3 position;
    float radius;
    vec3 color;
};

layout(binding = 6) uniform Lights {
    Light lights[3];
    vec3 ambient;
    bool enabled;
    ivec2 grid;
    mat4 world;
    vec4 weights[2];
}
lights;
