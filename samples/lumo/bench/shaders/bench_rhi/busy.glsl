// Arithmetic that takes as long as it is told to. Two loops, because drivers cut one of more than 65 535 rounds.
uint busy(uint x, uint rounds) {
    for (uint round = 0u; round < rounds; ++round) {
        for (uint i = 0u; i < 256u; ++i) {
            x ^= x << 13;
            x ^= x >> 17;
            x ^= x << 5;
        }
    }
    return x;
}
