// The same for every texel of a target.
layout(push_constant) uniform Push { uint rounds; } push;
layout(location = 0) out vec4 color;

void main() {
    uint x = uint(gl_FragCoord.x) + 1u;
    for (uint round = 0u; round < push.rounds; ++round) {
        for (uint i = 0u; i < 256u; ++i) {
            x ^= x << 13;
            x ^= x >> 17;
            x ^= x << 5;
        }
    }
    color = vec4(x & 255u) / 255.0;
}
