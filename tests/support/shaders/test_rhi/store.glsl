// Writes push.base + x + 16 y + 256 z into each texel. IMAGE and POSITION (of p) are the includer's.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    uvec3 size;
    float base;
} push;

layout(binding = 0) writeonly uniform IMAGE target;

void main() {
    ivec3 p = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(p, ivec3(push.size)))) return;
    imageStore(target, POSITION, vec4(push.base + float(p.x + 16 * p.y + 256 * p.z), 0.0, 0.0, 1.0));
}
