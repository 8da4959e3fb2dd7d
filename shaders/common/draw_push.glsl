// What changes from draw to draw.
layout(push_constant) uniform DrawPush {
    uint first_instance;
} draw;
