// Numbers on the CPU that the atmosphere's tables are made with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumo::atmosphere {

struct Node {
    double x, weight;
};
/// The rule of Gauss and Legendre on [0, 1], exact for polynomials of degree 2 count - 1.
std::vector<Node> gauss_legendre(uint32_t count);

/// The polynomials of least degree that are 1 at one node of such a rule and 0 at the others, at x.
std::vector<double> interpolation(std::span<const Node> rule, double x);

/// The integrals over directions of p P_l for l = 0 … degree, where p is the phase function of Cornette and Shanks: 1 at
/// l = 0, and p = sum of (2 l + 1) / (4 pi) times them times P_l.
std::vector<double> cornette_shanks_moments(double g, uint32_t degree);

/// The sum of (2 l + 1) / (4 pi) moments[l]^power P_l(nu) over the degrees above `degree`: what is left of the phase
/// function, convolved with itself power - 1 times, without its lower degrees.
double peak(const std::vector<double>& moments, uint32_t degree, uint32_t power, double nu);

/// The irradiance of that on a plane, nu being the cosine between its normal and the peak's direction: the integral of
/// the peak over the hemisphere, weighted with cosines.
double peak_irradiance(const std::vector<double>& moments, uint32_t degree, uint32_t power, double nu);

/// The associated Legendre functions of order m and degrees m … degree at mu, normalised so that times cos(m phi) they
/// are orthonormal on the sphere.
std::vector<double> harmonics(uint32_t m, uint32_t degree, double mu);

}  // namespace lumo::atmosphere
