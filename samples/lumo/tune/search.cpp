#include "samples/lumo/tune/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lumo::program {
namespace {

constexpr double least = 1e-12;  // a logarithm's argument

constexpr double unknown_part = 0.15;  // of cost and error, an axis

double logarithm(double value) { return std::log(std::max(value, least)); }

bool finite(const Tradeoff& choice) { return std::isfinite(choice.cost) && std::isfinite(choice.error); }

/// How far beyond the bounds, as a factor; at most 1: within.
double excess(const Goal& goal, const Tradeoff& choice) {
    double most = 0;
    if (goal.max_error) most = std::max(most, choice.error / std::max(*goal.max_error, least));
    if (goal.max_cost) most = std::max(most, choice.cost / std::max(*goal.max_cost, least));
    return std::isnan(most) ? std::numeric_limits<double>::infinity() : most;
}

/// Two ways in which the effects of axes may add up: to factors of cost and error, or to terms of the cost and, as what is
/// independent does, of the squared error.
enum class Law : uint8_t { factors, terms };
constexpr std::array laws{Law::factors, Law::terms};

/// Cost and error as numbers whose differences an axis adds.
std::array<double, 2> terms_of(Law law, const Tradeoff& choice) {
    if (law == Law::terms) return {choice.cost, choice.error * choice.error};
    return {logarithm(choice.cost), logarithm(choice.error)};
}

/// The way back; as a logarithm, and of what the terms make less than a tenth of the start's, that.
std::array<double, 2> logarithms_of(Law law, const std::array<double, 2>& terms,
                                    const std::array<double, 2>& start) {
    if (law == Law::factors) return terms;
    return {logarithm(std::max(terms[0], 0.1 * start[0])),
            0.5 * logarithm(std::max(terms[1], 0.01 * start[1]))};
}

struct Measured {
    Place place;
    Tradeoff choice;
    std::array<std::array<double, 2>, laws.size()> off{};  ///< of what a law foretold, in logarithms
};

/// Knows what was measured and foretells the rest.
class Model {
  public:
    explicit Model(const SearchSpace& space) : start_(space.start) {
        for (auto& effects : effects_)
            for (const size_t count : space.values) effects.emplace_back(count);
    }

    void add(const Place& place, const Tradeoff& choice) {
        const std::vector<size_t> moved = moved_axes(place);
        Measured measured{.place = place, .choice = choice};
        for (const Law law : laws) {
            const auto l = size_t(law);
            const std::array<double, 2> terms = terms_of(law, choice);
            if (moved.empty()) base_[l] = terms;
            if (moved.size() == 1) {
                for (size_t i = 0; i < 2; ++i)
                    effects_[l][moved.front()][place[moved.front()]][i] = terms[i] - base_[l][i];
            }
            if (moved.size() > 1 && finite(choice)) {
                const std::array<double, 2> foretold = logarithms(law, place);
                for (size_t i = 0; i < 2; ++i)
                    measured.off[l][i] = terms_of(Law::factors, choice)[i] - foretold[i];
            }
        }
        all_.push_back(std::move(measured));
    }

    /// Measured again.
    void correct(const Place& place, const Tradeoff& choice) {
        std::ranges::find(all_, place, &Measured::place)->choice = choice;
    }

    bool knows(const Place& place) const {
        return std::ranges::find(all_, place, &Measured::place) != all_.end();
    }
    const std::vector<Measured>& all() const { return all_; }

    /// The mean of what the laws say, and a part better for each axis on which all that was measured lies elsewhere:
    /// what is far from it is known badly, and may be worth a trial.
    Tradeoff foretell(const Place& place) const {
        std::array<double, 2> mean{};
        for (const Law law : laws) {
            std::array<double, 2> sums{};
            double weights = 0;
            for (const Measured& other : all_) {
                const auto apart = double(axes_apart(place, other.place));
                const double weight = 1 / (apart * apart * apart * apart);
                weights += weight;
                for (size_t i = 0; i < 2; ++i) sums[i] += weight * other.off[size_t(law)][i];
            }
            const std::array<double, 2> foretold = logarithms(law, place);
            for (size_t i = 0; i < 2; ++i) mean[i] += (foretold[i] + sums[i] / weights) / double(laws.size());
        }
        const double unknown = unknown_part * nearest(place);
        return {std::exp(mean[0] - unknown), std::exp(mean[1] - unknown)};
    }

  private:
    static size_t axes_apart(const Place& a, const Place& b) {
        size_t apart = 0;
        for (size_t axis = 0; axis < a.size(); ++axis) apart += a[axis] != b[axis];
        return apart;
    }

    double nearest(const Place& place) const {
        size_t least = place.size();
        for (const Measured& other : all_) least = std::min(least, axes_apart(place, other.place));
        return double(least);
    }

    std::vector<size_t> moved_axes(const Place& place) const {
        std::vector<size_t> axes;
        for (size_t axis = 0; axis < place.size(); ++axis)
            if (place[axis] != start_[axis]) axes.push_back(axis);
        return axes;
    }

    std::array<double, 2> logarithms(Law law, const Place& place) const {
        const std::array<double, 2>& base = base_[size_t(law)];
        std::array<double, 2> value = base;
        for (size_t axis = 0; axis < place.size(); ++axis)
            for (size_t i = 0; i < 2; ++i) value[i] += effects_[size_t(law)][axis][place[axis]][i];
        return logarithms_of(law, value, base);
    }

    using Effects = std::vector<std::vector<std::array<double, 2>>>;  ///< by axis and value

    Place start_;
    std::array<std::array<double, 2>, laws.size()> base_{};
    std::array<Effects, laws.size()> effects_;
    std::vector<Measured> all_;
};

/// The next place in counting order; false after the last one.
bool advance(Place& place, const std::vector<size_t>& values) {
    for (size_t axis = 0; axis < place.size(); ++axis) {
        if (++place[axis] < values[axis]) return true;
        place[axis] = 0;
    }
    return false;
}

class Search {
  public:
    Search(const SearchSpace& space, const Goal& goal, const SearchLimits& limits, const Measure& measure)
        : space_(space), goal_(goal), limits_(limits), measure_(measure), model_(space) {}

    Result<void> try_axes() {
        Result<void> done = try_place(space_.start);
        for (size_t axis = 0; axis < space_.values.size(); ++axis) {
            for (size_t value = 0; value < space_.values[axis]; ++value) {
                Place place = space_.start;
                place[axis] = value;
                if (done && value != space_.start[axis] && has_trials()) done = try_place(place);
            }
        }
        return done;
    }

    Result<void> try_promising() {
        for (size_t in_vain = 0; in_vain < limits_.patience && has_trials();) {
            const std::optional<Place> place = most_promising();
            if (!place || !goal_.prefers(model_.foretell(*place), best().choice)) break;
            const Tradeoff before = best().choice;
            if (Result<void> done = try_place(*place); !done) return done;
            in_vain = goal_.prefers(best().choice, before) ? 0 : in_vain + 1;
        }
        return {};
    }

    const Measured& best() const {
        return *std::ranges::min_element(model_.all(), [&](const Measured& a, const Measured& b) {
            return goal_.prefers(a.choice, b.choice);
        });
    }

    void correct(const Place& place, const Tradeoff& choice) { model_.correct(place, choice); }
    size_t trials() const { return model_.all().size(); }

  private:
    bool has_trials() const { return trials() < limits_.trials; }

    Result<void> try_place(const Place& place) {
        return measure_(place).map([&](const Tradeoff& choice) { model_.add(place, choice); });
    }

    std::optional<Place> most_promising() const {
        std::optional<Place> best;
        Tradeoff promise;
        Place place(space_.values.size(), 0);
        do {
            if (model_.knows(place)) continue;
            const Tradeoff foretold = model_.foretell(place);
            if (!finite(foretold) || (best && !goal_.prefers(foretold, promise))) continue;
            best = place;
            promise = foretold;
        } while (advance(place, space_.values));
        return best;
    }

    const SearchSpace& space_;
    const Goal& goal_;
    const SearchLimits& limits_;
    const Measure& measure_;
    Model model_;
};

}  // namespace

bool Goal::met_by(const Tradeoff& choice) const { return excess(*this, choice) <= 1; }

bool Goal::prefers(const Tradeoff& choice, const Tradeoff& other) const {
    const bool met = met_by(choice), other_met = met_by(other);
    if (met != other_met) return met;
    if (!met) return excess(*this, choice) < excess(*this, other);
    return max_error ? choice.cost < other.cost : choice.error < other.error;
}

size_t SearchSpace::size() const {
    size_t product = 1;
    for (const size_t count : values) product *= count;
    return product;
}

Result<SearchResult> search(const SearchSpace& space, const Goal& goal, const SearchLimits& limits,
                            const Measure& measure, const Measure& again) {
    Search search(space, goal, limits, measure);
    if (Result<void> done = search.try_axes(); !done) return tl::unexpected(done.error());
    // Each pass ends with a choice that keeps its promise, or knows of one more that does not.
    std::vector<Place> confirmed;
    for (;;) {
        if (Result<void> done = search.try_promising(); !done) return tl::unexpected(done.error());
        const Place place = search.best().place;
        const Tradeoff choice = search.best().choice;
        const bool met = goal.met_by(choice);
        if (!met || std::ranges::find(confirmed, place) != confirmed.end())
            return SearchResult{.place = place, .choice = choice, .met = met, .trials = search.trials()};
        const Result<Tradeoff> second = again(place);
        if (!second) return tl::unexpected(second.error());
        confirmed.push_back(place);
        search.correct(place, *second);
    }
}

}  // namespace lumo::program
