// Which of several choices are worth taking.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace lumo::program {

/// What a choice costs, and what it still gets wrong.
struct Tradeoff {
    double cost = 0;
    double error = 0;
};

/// The Pareto front: the choices than which none is both at least as cheap and at least as accurate, and better in one
/// of the two; of equal ones the first. Places in `choices`, by ascending cost. A choice with a value that is not
/// finite is never on it.
inline std::vector<size_t> pareto_front(std::span<const Tradeoff> choices) {
    std::vector<size_t> order(choices.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::erase_if(
        order, [&](size_t i) { return !std::isfinite(choices[i].cost) || !std::isfinite(choices[i].error); });
    std::ranges::stable_sort(order, [&](size_t a, size_t b) {
        const Tradeoff &x = choices[a], &y = choices[b];
        return x.cost != y.cost ? x.cost < y.cost : x.error < y.error;
    });
    std::vector<size_t> front;
    for (const size_t i : order)
        if (front.empty() || choices[i].error < choices[front.back()].error) front.push_back(i);
    return front;
}

/// How much a choice's error is above the least that is to be had at its cost, as a part of that; 0 on the front.
inline double above_front(std::span<const Tradeoff> choices, size_t choice) {
    double least = choices[choice].error;
    for (const Tradeoff& other : choices)
        if (other.cost <= choices[choice].cost && other.error < least) least = other.error;
    return least > 0 ? choices[choice].error / least - 1 : 0;
}

}  // namespace lumo::program
