// The Pareto front, of numbers alone.
#include <gmock/gmock.h>
#include <limits>
#include <random>

#include "samples/lumo/report/pareto.hpp"

namespace lumo::program {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double none = std::numeric_limits<double>::infinity();

TEST(ParetoFront, IsWhatNothingBeats) {
    const std::vector<Tradeoff> choices{{5, 1}, {1, 9}, {2, 9}, {2, 4}, {3, 4}, {4, 8}, {9, 0.5}};
    EXPECT_THAT(pareto_front(choices), ElementsAre(1, 3, 0, 6));
}

TEST(ParetoFront, OfEqualChoicesHasTheFirst) {
    EXPECT_THAT(pareto_front(std::vector<Tradeoff>{{1, 1}, {1, 1}}), ElementsAre(0));
    EXPECT_THAT(pareto_front(std::vector<Tradeoff>{{1, 2}, {1, 1}}), ElementsAre(1));
    EXPECT_THAT(pareto_front(std::vector<Tradeoff>{{2, 1}, {1, 1}}), ElementsAre(1));
}

TEST(ParetoFront, LeavesOutWhatWasNotMeasured) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(pareto_front(std::vector<Tradeoff>{{none, 0}, {0, none}, {nan, 0}, {0, nan}}), IsEmpty());
    EXPECT_THAT(pareto_front(std::vector<Tradeoff>{{none, 0}, {3, 3}}), ElementsAre(1));
    EXPECT_THAT(pareto_front({}), IsEmpty());
}

TEST(ParetoFront, AgreesWithItsDefinition) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> value(0, 20);
    for (int round = 0; round < 200; ++round) {
        std::vector<Tradeoff> choices;
        for (int i = 0; i < 30; ++i) choices.push_back({double(value(random)), double(value(random))});
        const std::vector<size_t> front = pareto_front(choices);
        for (size_t i = 0; i < choices.size(); ++i) {
            bool beaten = false;
            for (size_t j = 0; j < choices.size(); ++j) {
                const bool no_worse =
                    choices[j].cost <= choices[i].cost && choices[j].error <= choices[i].error;
                const bool better = choices[j].cost < choices[i].cost || choices[j].error < choices[i].error;
                beaten |= no_worse && (better || j < i);
            }
            EXPECT_EQ(std::ranges::find(front, i) == front.end(), beaten) << "round " << round << ", " << i;
            EXPECT_TRUE(beaten || above_front(choices, i) == 0);
        }
    }
}

TEST(AboveFront, IsTheErrorOverTheLeastAtItsCost) {
    const std::vector<Tradeoff> choices{{1, 4}, {2, 2}, {3, 3}, {none, 1}, {4, 1}};
    EXPECT_DOUBLE_EQ(above_front(choices, 2), 0.5);
    EXPECT_EQ(above_front(choices, 1), 0);
    EXPECT_EQ(above_front(choices, 0), 0);
}

}  // namespace
}  // namespace lumo::program
