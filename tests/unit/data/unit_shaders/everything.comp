// One of each kind of binding, a push block and every type of option.
#include "common_light.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 2) in;

layout(constant_id = 7) const float scale = 0.1;
layout(constant_id = 2) const bool fast = true;
layout(constant_id = 4) const int bias = -3;
layout(constant_id = 5) const uint count = 12;

layout(binding = 9) uniform usampler2DArray codes;
layout(binding = 0) uniform sampler3D radiance;
layout(binding = 1, r32ui) uniform uimage3D counts;
layout(binding = 2, rgba16f) writeonly uniform image2D result;
layout(binding = 3, std430) readonly buffer Samples {
    uint first;
    vec4 values[];
}
samples;
layout(binding = 4, std430) LUMO_READ_WRITE buffer State { vec4 value; };
layout(binding = 5, std430) buffer Totals {
    uint sum;
    uint highest;
}
totals;

layout(push_constant) uniform Push {
    vec3 origin;
    float step;
    mat4 clip;
    uvec2 size;
    int level;
}
push;

void count_at(ivec3 at) { imageAtomicAdd(counts, at, 1u); }

void main() {
    uvec3 id = gl_GlobalInvocationID;
    count_at(ivec3(id));
    vec4 sum = value + texture(radiance, push.origin + push.step * vec3(id));
    for (uint i = 0; i < count; ++i) sum += samples.values[samples.first + i] * scale;
    if (lights.enabled) sum += push.clip * vec4(lights.lights[2].position, lights.ambient.x) * lights.weights[1];
    atomicAdd(totals.sum, texelFetch(codes, ivec3(id), 0).x + uint(bias) + push.size.y + uint(push.level));
    atomicMax(totals.highest, uint(lights.grid.y));
    value = fast ? sum : lights.world * sum;
    imageStore(result, ivec2(id.xy), sum);
}
