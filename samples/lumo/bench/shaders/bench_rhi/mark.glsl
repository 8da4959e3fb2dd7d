layout(push_constant) uniform Push {
    vec4 tint;
    vec2 place;
    float scale;
} push;
