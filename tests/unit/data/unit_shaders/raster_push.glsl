layout(push_constant) uniform Push {
    vec2 offset;
    uint layer;
}
push;
