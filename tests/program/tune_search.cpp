// The search that tune makes, over costs and errors that are known everywhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <set>

#include "samples/lumo/tune/search.hpp"

namespace lumo::program {
namespace {

/// A renderer made up: voxels and cones, whose costs add and whose errors add in squares, a factor on each, a switch that
/// helps few cones alone, and a storage that fails for the finest voxels.
const SearchSpace space{.values = {4, 8, 2, 2, 2, 3}, .start = {2, 4, 1, 0, 0, 0}};

Tradeoff renderer(const Place& p) {
    constexpr double none = std::numeric_limits<double>::infinity();
    constexpr std::array voxels{32, 64, 128, 256};
    constexpr std::array cones{1, 3, 5, 7, 9, 12, 18, 28};
    const double n = voxels[p[0]], c = cones[p[1]];
    const bool directional = p[2] == 1, turned = p[3] == 1, sparse = p[4] == 1;
    const double bounces = 1 << p[5];
    if (sparse && n == 256) return {none, none};
    const double gather = 0.4 * c * std::log2(n) * (directional ? 1.4 : 1) * (sparse ? 2.5 : 1);
    const double build = 2e-6 * n * n * n * (directional ? 1.6 : 1) * (sparse ? 0.6 : 1);
    const double of_voxels = 12.0 / n * (directional ? 1 : 1.8);
    const double of_cones = 0.5 / c * (turned ? (c < 8 ? 0.6 : 0.95) : 1);
    const double of_bounces = 0.12 / bounces;
    return {1 + gather + build * (1 + 0.3 * (bounces - 1)),
            std::sqrt(of_voxels * of_voxels + of_cones * of_cones + of_bounces * of_bounces)};
}

std::vector<Place> all_places() {
    std::vector<Place> places{Place(space.values.size(), 0)};
    for (size_t i = 0; i < places.size(); ++i) {
        // From each place those with one more on the first axes up to the first that is not 0 already.
        for (size_t axis = 0; axis < space.values.size(); ++axis) {
            Place next = places[i];
            if (next[axis] + 1 < space.values[axis]) {
                ++next[axis];
                places.push_back(next);
            }
            if (places[i][axis] > 0) break;
        }
    }
    return places;
}

Tradeoff best_of_all(const Goal& goal) {
    Tradeoff best = renderer(space.start);
    for (const Place& place : all_places())
        if (goal.prefers(renderer(place), best)) best = renderer(place);
    return best;
}

TEST(TuneSearch, FindsNearlyTheBestWithAFifthOfTheTrials) {
    const std::vector<Place> places = all_places();
    ASSERT_EQ(std::set<Place>(places.begin(), places.end()).size(), space.size());
    std::vector<Goal> goals;
    for (const double error : {0.09, 0.1, 0.12, 0.15, 0.2, 0.3, 0.5}) goals.push_back({.max_error = error});
    for (const double cost : {3.5, 5.0, 8.0, 12.0, 20.0, 40.0, 80.0}) goals.push_back({.max_cost = cost});
    for (const double error : {0.12, 0.2}) goals.push_back({.max_error = error, .max_cost = 60});
    for (const Goal& goal : goals) {
        SCOPED_TRACE(fmt::format("error {}, cost {}", goal.max_error.value_or(0), goal.max_cost.value_or(0)));
        std::set<Place> measured;
        size_t confirmed = 0;
        const auto found = search(
            space, goal, {.trials = space.size() / 5},
            [&](const Place& place) -> Result<Tradeoff> {
                EXPECT_TRUE(measured.insert(place).second) << "measured twice";
                return renderer(place);
            },
            [&](const Place& place) -> Result<Tradeoff> {
                ++confirmed;
                return renderer(place);
            });
        ASSERT_TRUE(found);
        const Tradeoff best = best_of_all(goal);
        EXPECT_TRUE(goal.met_by(best));
        EXPECT_TRUE(found->met);
        EXPECT_TRUE(goal.met_by(found->choice));
        EXPECT_EQ(confirmed, 1);
        EXPECT_EQ(found->trials, measured.size());
        EXPECT_LE(found->trials, space.size() / 5);
        const double value = goal.max_error ? found->choice.cost : found->choice.error;
        const double least = goal.max_error ? best.cost : best.error;
        RecordProperty(fmt::format("error_{}_cost_{}", goal.max_error.value_or(0), goal.max_cost.value_or(0)),
                       fmt::format("{:.4f} of {:.4f} in {} trials", value, least, found->trials));
        EXPECT_LE(value, 1.05 * least) << found->trials << " trials";
    }
}

TEST(TuneSearch, WhatCannotBeMetIsSaidWithTheNearest) {
    for (const Goal& goal : {Goal{.max_error = 0.01}, Goal{.max_cost = 0.5}}) {
        bool confirmed = false;
        const auto found = search(
            space, goal, {.trials = space.size() / 5},
            [](const Place& p) -> Result<Tradeoff> { return renderer(p); },
            [&](const Place& p) -> Result<Tradeoff> {
                confirmed = true;
                return renderer(p);
            });
        ASSERT_TRUE(found);
        EXPECT_FALSE(found->met);
        EXPECT_FALSE(confirmed);
        const Tradeoff best = best_of_all(goal);
        EXPECT_LE(goal.max_error ? found->choice.error : found->choice.cost,
                  1.1 * (goal.max_error ? best.error : best.cost));
    }
}

/// The second measurement is what counts.
TEST(TuneSearch, AChoiceThatDoesNotKeepItsPromiseIsPassedOver) {
    const Goal goal{.max_error = 0.2};
    std::vector<Place> refused;
    const auto found = search(
        space, goal, {.trials = space.size() / 5},
        [](const Place& p) -> Result<Tradeoff> { return renderer(p); },
        [&](const Place& p) -> Result<Tradeoff> {
            if (refused.size() == 2) return renderer(p);
            refused.push_back(p);
            return Tradeoff{renderer(p).cost, 0.21};
        });
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->met);
    EXPECT_EQ(refused.size(), 2);
    EXPECT_EQ(std::ranges::count(refused, found->place), 0);
    EXPECT_LE(found->choice.error, 0.2);
}

TEST(TuneSearch, AnErrorOfMeasuringEndsIt) {
    const auto broken = [](const Place&) -> Result<Tradeoff> {
        return fail(ErrorKind::io, "device", "lost");
    };
    EXPECT_FALSE(search(space, {.max_error = 0.2}, {.trials = 10}, broken, broken));
}

}  // namespace
}  // namespace lumo::program
