// One link of a chain: it reads what the one before it wrote.
layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
    uint factor;
    uint addend;
} push;
layout(binding = 0) uniform sampler2D picture;
layout(std430, binding = 1) readonly buffer Source { uint source[]; };
layout(std430, binding = 2) writeonly buffer Target { uint target[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    uint texel = uint(255.0 * texelFetch(picture, ivec2(0), 0).g + 0.5);
    target[i] = source[i] * push.factor + push.addend + texel;
}
