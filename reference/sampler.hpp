// Numbers for Monte Carlo integration.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace lumo::reference {

/// A well-mixed word of two (the finalizer of MurmurHash3, twice).
constexpr uint32_t hash(uint32_t a, uint32_t b) {
    const auto mix = [](uint32_t x) {
        x = (x ^ x >> 16) * 0x85ebca6bu;
        x = (x ^ x >> 13) * 0xc2b2ae35u;
        return x ^ x >> 16;
    };
    return mix(mix(a + 0x9e3779b9u) ^ (b + 0x7f4a7c15u));
}

/// To (0, 1), never an end.
constexpr double to_unit(uint32_t bits) { return (double(bits) + 0.5) * 0x1p-32; }

/// The numbers of one sample of a pixel, by dimension; a pure function of its arguments, so that the order in which
/// pixels are done says nothing. Each dimension is a Sobol' sequence in two dimensions with an Owen scramble of its
/// own, also of its order (Burley 2020, Practical Hash-based Owen Scrambling). Each sample by itself is uniformly
/// distributed; streams are independent of each other.
class Sampler {
  public:
    Sampler(uint32_t stream, uint32_t index) : stream_(stream), index_(index) {}

    glm::dvec2 pair(uint32_t dimension) const;
    double number(uint32_t dimension) const { return pair(dimension).x; }
    uint32_t word(uint32_t dimension) const { return hash(hash(stream_, index_), dimension); }

  private:
    uint32_t stream_;
    uint32_t index_;
};

/// Directions about +z by the cosine, density cos / pi per steradian.
glm::dvec3 cosine_direction(glm::dvec2 u);

/// Two unit vectors that make a right-handed frame with a unit normal, the last column (Duff et al. 2017, Building an
/// Orthonormal Basis, Revisited).
glm::dmat3 frame_about(glm::dvec3 normal);

}  // namespace lumo::reference
