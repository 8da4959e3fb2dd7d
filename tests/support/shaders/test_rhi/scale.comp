layout(local_size_x = 64) in;

layout(constant_id = 0) const int bias = 0;
layout(constant_id = 3) const bool negate = false;
layout(constant_id = 5) const uint shift = 0u;
layout(constant_id = 6) const float step = 1.0;

layout(push_constant) uniform Push {
    uint count;
    int factor;
    vec2 pair;
} push;

layout(std430, binding = 0) readonly buffer Source { int source[]; };
layout(std430, binding = 4) writeonly buffer Target { int target[]; };
layout(std140, binding = 2) uniform Settings {
    ivec4 addend;
} settings;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    int value = source[i] * push.factor + settings.addend[i % 4u] + bias + int(push.pair.x * push.pair.y);
    target[i] = ((negate ? -value : value) << shift) + int(step);
}
