// One step of x -> 3 x + 1, whose repetition shows a lost or doubled step.
layout(local_size_x = 64) in;
layout(std430, binding = 0) LUMO_READ_WRITE buffer Values { uint values[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(values.length())) values[i] = values[i] * 3u + 1u;
}
