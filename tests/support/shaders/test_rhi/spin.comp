// Much arithmetic that cannot be left out.
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint rounds; } push;
layout(std430, binding = 0) writeonly buffer Result { uint result[]; };

void main() {
    uint x = gl_GlobalInvocationID.x + 1u;
    for (uint round = 0u; round < push.rounds; ++round) {
        for (uint i = 0u; i < 1000u; ++i) {
            x ^= x << 13;
            x ^= x >> 17;
            x ^= x << 5;
        }
    }
    result[gl_GlobalInvocationID.x] = x;
}
