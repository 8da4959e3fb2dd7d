// Counts fragments without any target.
layout(std430, binding = 0) buffer Tally { uint fragments; } tally;

void main() { atomicAdd(tally.fragments, 1u); }
