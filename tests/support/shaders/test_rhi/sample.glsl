// Reads a texture at given points. SAMPLER, COORDINATE (a swizzle of a point) and RESULT are the includer's.
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    uint count;
    float lod;
} push;

layout(binding = 0) uniform SAMPLER source;
layout(std430, binding = 1) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 2) writeonly buffer Results { RESULT results[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < push.count) results[i] = textureLod(source, points[i].COORDINATE, push.lod);
}
