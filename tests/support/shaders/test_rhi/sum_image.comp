// Adds to a volume's texels: every invocation one, to the texel of its remainder.
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uvec3 size; } push;
layout(binding = 3, r32ui) uniform uimage3D counts;

void main() {
    uint i = gl_GlobalInvocationID.x % (push.size.x * push.size.y * push.size.z);
    imageAtomicAdd(counts, ivec3(i % push.size.x, i / push.size.x % push.size.y, i / (push.size.x * push.size.y)), 1u);
}
