// Writes the arguments of indirect work.
layout(local_size_x = 1) in;
layout(push_constant) uniform Push { uvec4 words; uint last; } push;
layout(std430, binding = 0) writeonly buffer Arguments { uint words[]; };

void main() {
    for (uint i = 0u; i < 4u; ++i) words[i] = push.words[i];
    words[4] = push.last;
}
