#include "techniques/atmosphere/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumo::atmosphere {

/// Newton's method from Tricomi's approximation of the roots (Abramowitz and Stegun 22.16.6).
std::vector<Node> gauss_legendre(uint32_t count) {
    std::vector<Node> nodes(count);
    for (uint32_t i = 0; i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
        for (int step = 0; step < 50; ++step) {
            double p = 1, before = 0;
            for (uint32_t l = 0; l < count; ++l) {
                const double next = ((2 * l + 1) * x * p - l * before) / (l + 1);
                before = p;
                p = next;
            }
            slope = count * (before - x * p) / ((1 - x) * (1 + x));
            const double change = p / slope;
            x -= change;
            if (std::abs(change) < 1e-15) break;
        }
        nodes[count - 1 - i] = {.x = 0.5 + 0.5 * x, .weight = 1 / ((1 - x) * (1 + x) * slope * slope)};
    }
    return nodes;
}

/// Henyey and Greenstein's are g^l; times nu² by the recurrence of Legendre's polynomials, twice.
std::vector<double> cornette_shanks_moments(double g, uint32_t degree) {
    std::vector<double> lobe(degree + 3);
    for (size_t l = 0; l < lobe.size(); ++l) lobe[l] = std::pow(g, double(l));
    const auto times_nu = [](const std::vector<double>& of) {
        std::vector<double> product(of.size() - 1);
        for (size_t l = 0; l < product.size(); ++l)
            product[l] =
                (double(l + 1) * of[l + 1] + (l > 0 ? double(l) * of[l - 1] : 0)) / double(2 * l + 1);
        return product;
    };
    std::vector<double> moments = times_nu(times_nu(lobe));
    for (size_t l = 0; l < moments.size(); ++l) moments[l] = 1.5 * (moments[l] + lobe[l]) / (2 + g * g);
    return moments;
}

double peak(const std::vector<double>& moments, uint32_t degree, uint32_t power, double nu) {
    double p = 1, before = 0, sum = 0;
    for (size_t l = 0; l < moments.size(); ++l) {
        if (l > degree)
            sum += double(2 * l + 1) / (4 * std::numbers::pi) * std::pow(moments[l], double(power)) * p;
        const double next = (double(2 * l + 1) * nu * p - double(l) * before) / double(l + 1);
        before = p;
        p = next;
    }
    return sum;
}

/// By the recurrence in the degree, which is stable upward.
std::vector<double> harmonics(uint32_t m, uint32_t degree, double mu) {
    std::vector<double> p;
    const double sine = std::sqrt(std::max(1 - mu * mu, 0.0));
    double value = std::sqrt((m == 0 ? 1 : 2) / (4 * std::numbers::pi)), before = 0;
    for (uint32_t i = 1; i <= m; ++i) value *= sine * std::sqrt((2.0 * i - 1) / (2.0 * i));
    value *= std::sqrt(2.0 * m + 1);
    for (uint32_t l = m; l <= degree; ++l) {
        p.push_back(value);
        const double l2 = double(l) * l, m2 = double(m) * m, next2 = double(l + 1) * (l + 1);
        const double next = std::sqrt((4 * next2 - 1) / (next2 - m2)) *
                            (mu * value - (l > m ? std::sqrt((l2 - m2) / (4 * l2 - 1)) * before : 0));
        before = value;
        value = next;
    }
    return p;
}

}  // namespace lumo::atmosphere
