// What changes from draw to draw: where its instances start, and its material.
layout(push_constant) uniform DrawPush {
    uint first_instance;
    uint material;
} draw;
