layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Numbers { uint values[]; } numbers;
layout(std430, binding = 1) writeonly buffer Squares { uint values[]; } squares;

layout(push_constant) uniform Push { uint count; } push;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < push.count) squares.values[i] = numbers.values[i] * numbers.values[i];
}
