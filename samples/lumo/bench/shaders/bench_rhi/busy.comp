#include "bench_rhi/busy.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint rounds; } push;
layout(std430, binding = 0) writeonly buffer Result { uint result[]; };

void main() {
    result[gl_GlobalInvocationID.x] = busy(gl_GlobalInvocationID.x + 1u, push.rounds);
}
