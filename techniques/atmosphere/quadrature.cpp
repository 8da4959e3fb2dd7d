#include "techniques/atmosphere/quadrature.hpp"

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

}  // namespace lumo::atmosphere
