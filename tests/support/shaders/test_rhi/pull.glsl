layout(push_constant) uniform Push {
    vec4 tint;
    vec2 offset;
} push;
