#include "reference/sampler.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace lumo::reference {
namespace {

uint32_t reverse_bits(uint32_t x) {
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
    return x >> 16 | x << 16;
}

/// Flips every bit by a hash of the bits above it. Within, bits are reversed, because multiplication carries upward
/// (Laine and Karras 2011, Stratified Sampling for Stochastic Transparency; the factors are Burley's).
uint32_t owen_scramble(uint32_t x, uint32_t seed) {
    x = reverse_bits(x);
    x += seed;
    for (const uint32_t factor : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u}) x ^= x * factor;
    return reverse_bits(x);
}

/// The second dimension of Sobol's sequence; the first is reverse_bits.
uint32_t sobol_second(uint32_t index) {
    uint32_t result = 0;
    for (uint32_t direction = 1u << 31; index != 0; index >>= 1, direction ^= direction >> 1)
        if (index & 1) result ^= direction;
    return result;
}

}  // namespace

glm::dvec2 Sampler::pair(uint32_t dimension) const {
    const uint32_t seed = hash(stream_, dimension);
    const uint32_t index = owen_scramble(index_, seed);
    return {to_unit(owen_scramble(reverse_bits(index), hash(seed, 1))),
            to_unit(owen_scramble(sobol_second(index), hash(seed, 2)))};
}

glm::dvec3 cosine_direction(glm::dvec2 u) {
    const double radius = std::sqrt(u.x), angle = 2 * std::numbers::pi * u.y;
    return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u.x)};
}

glm::dmat3 frame_about(glm::dvec3 n) {
    const double s = std::copysign(1.0, n.z);
    const double a = -1 / (s + n.z);
    const double b = n.x * n.y * a;
    return {glm::dvec3(1 + s * n.x * n.x * a, s * b, -s * n.x), glm::dvec3(b, s + n.y * n.y * a, -n.y), n};
}

}  // namespace lumo::reference
