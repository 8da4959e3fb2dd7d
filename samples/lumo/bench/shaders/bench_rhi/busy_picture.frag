#include "bench_rhi/busy.glsl"

// The same for every texel of a target.
layout(push_constant) uniform Push { uint rounds; } push;
layout(location = 0) out vec4 color;

void main() { color = vec4(busy(uint(gl_FragCoord.x) + 1u, push.rounds) & 255u) / 255.0; }
