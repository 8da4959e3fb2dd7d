// The best of many configurations, found by measuring few of them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rhi/error.hpp"
#include "samples/lumo/report/pareto.hpp"

namespace lumo::program {

/// What is wanted: the cheapest of those within max_error; else the most accurate within max_cost. With both bounds, the
/// cheapest within both. At least one is there.
struct Goal {
    std::optional<double> max_error = {};
    std::optional<double> max_cost = {};

    bool met_by(const Tradeoff& choice) const;
    /// Whether a choice is worth more than another: what meets the goal before what does not; of those that do, as the
    /// goal says; of the others the one that is nearer to the bounds, as a ratio.
    bool prefers(const Tradeoff& choice, const Tradeoff& other) const;
};

/// One value of each axis.
using Place = std::vector<size_t>;

/// Every combination of a value of each axis.
struct SearchSpace {
    std::vector<size_t> values;  ///< of each axis, 1 and up
    Place start;                 ///< where the search begins

    size_t size() const;
};

struct SearchLimits {
    size_t trials = 0;     ///< at most; none are made beyond
    size_t patience = 12;  ///< trials without a better choice, after which there is taken to be none
};

/// What a configuration costs and gets wrong; infinite where it cannot be had.
using Measure = std::function<Result<Tradeoff>(const Place&)>;

struct SearchResult {
    Place place;
    Tradeoff choice;
    bool met = false;
    size_t trials = 0;  ///< places measured, each once
};

/// Measures the start, then every other value of each axis by itself. What an axis changes is taken to be the same whatever
/// the other axes are, as a factor and as a term of the cost and of the squared error, of which the mean is taken; that is
/// corrected by how far it was off at the places measured since, the nearest most. The most promising place is measured
/// next, until none promises more than the best one measured, or the limits are reached. The best that meets the goal is
/// then measured by `again`, which should share nothing with the first time but the configuration; where it does not keep
/// its promise, the search goes on with what was found. Errors: those of measuring.
Result<SearchResult> search(const SearchSpace& space, const Goal& goal, const SearchLimits& limits,
                            const Measure& measure, const Measure& again);

}  // namespace lumo::program
