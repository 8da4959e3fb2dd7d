// Adds every invocation to the counter of its remainder.
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint counters; } push;
layout(std430, binding = 0) buffer Counters { uint counters[]; };

void main() { atomicAdd(counters[gl_GlobalInvocationID.x % push.counters], 1u); }
