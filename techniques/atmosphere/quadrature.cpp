#include "techniques/atmosphere/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

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

/// A sum over Legendre's polynomials, which are orthogonal under the rule too.
std::vector<double> interpolation(std::span<const Node> rule, double x) {
    std::vector<double> values(rule.size(), 0);
    for (size_t i = 0; i < rule.size(); ++i) {
        double here = 1, here_before = 0, there = 1, there_before = 0;
        for (size_t l = 0; l < rule.size(); ++l) {
            values[i] += rule[i].weight * double(2 * l + 1) * here * there;
            const auto next = [l](double y, double p, double before) {
                return (double(2 * l + 1) * (2 * y - 1) * p - double(l) * before) / double(l + 1);
            };
            here_before = std::exchange(here, next(x, here, here_before));
            there_before = std::exchange(there, next(rule[i].x, there, there_before));
        }
    }
    return values;
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

namespace {

/// The sum of factor(l) P_l(nu) over the degrees from `first` to below `end`.
template <class F>
double legendre_series(size_t first, size_t end, double nu, const F& factor) {
    double p = 1, before = 0, sum = 0;
    for (size_t l = 0; l < end; ++l) {
        if (l >= first) sum += factor(l) * p;
        const double next = (double(2 * l + 1) * nu * p - double(l) * before) / double(l + 1);
        before = p;
        p = next;
    }
    return sum;
}

}  // namespace

double peak(const std::vector<double>& moments, uint32_t degree, uint32_t power, double nu) {
    return legendre_series(degree + 1, moments.size(), nu, [&](size_t l) {
        return double(2 * l + 1) / (4 * std::numbers::pi) * std::pow(moments[l], double(power));
    });
}

/// The cosine over a hemisphere has the degrees 0, 1 and, falling by their recurrence, the even ones; a convolution
/// multiplies (Ramamoorthi and Hanrahan 2001, An Efficient Representation for Irradiance Environment Maps, equation 8).
double peak_irradiance(const std::vector<double>& moments, uint32_t degree, uint32_t power, double nu) {
    std::vector<double> cosine(moments.size(), 0);  // integrals of mu P_l(mu) over [0, 1]
    double even = 0.5;
    for (size_t l = 0; l < cosine.size(); l += 2) {
        cosine[l] = even;
        even *= -(double(l) - 1) / (double(l) + 4);
    }
    if (cosine.size() > 1) cosine[1] = 1.0 / 3;
    return legendre_series(degree + 1, moments.size(), nu, [&](size_t l) {
        return 0.5 * double(2 * l + 1) * cosine[l] * std::pow(moments[l], double(power));
    });
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
