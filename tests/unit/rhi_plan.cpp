// The hazard plan as data: which barriers each sequence of scopes gets, and that each one is needed.
#include <algorithm>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "rhi/plan.hpp"

namespace lumo::rhi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr MemoryId buffer{MemoryId::Kind::buffer, 1, 0};
constexpr MemoryId other{MemoryId::Kind::buffer, 2, 0};
constexpr MemoryId mip0{MemoryId::Kind::texture, 1, 0};
constexpr MemoryId mip1{MemoryId::Kind::texture, 1, 1};
constexpr Access atomic = Access::storage_read | Access::storage_write;

Use compute(MemoryId memory, Access access, Layout layout = Layout::undefined) {
    return {.memory = memory, .access = access, .stages = Stages::compute, .layout = layout};
}

Use count(MemoryId memory) {
    Use use = compute(memory, atomic);
    use.commutative = true;
    return use;
}

Scope scope(std::vector<Use> uses, bool unordered = false) { return {"scope", std::move(uses), unordered}; }

/// How many barriers stand in front of each scope.
std::vector<size_t> counts(const std::vector<Scope>& scopes) {
    const auto plan = plan_barriers(scopes);
    EXPECT_THAT(find_hazards(scopes, plan), IsEmpty()) << to_text(scopes, plan);
    std::vector<size_t> sizes;
    sizes.reserve(plan.size());
    for (const auto& barriers : plan) sizes.push_back(barriers.size());
    return sizes;
}

TEST(Plan, FirstUsesOfBuffersNeedNoBarrier) {
    EXPECT_THAT(
        counts({scope({compute(buffer, Access::storage_read), compute(other, Access::storage_write)})}),
        ElementsAre(0));
}

TEST(Plan, ReadAfterWriteWaitsOncePerReader) {
    const Use read = compute(buffer, Access::storage_read);
    Use drawn = read;
    drawn.stages = Stages::vertex;
    EXPECT_THAT(counts({scope({compute(buffer, Access::storage_write)}), scope({read}), scope({read}),
                        scope({drawn}), scope({drawn}), scope({read})}),
                ElementsAre(0, 1, 0, 1, 0, 0));
}

TEST(Plan, AReaderInAnotherStageThroughAnotherAccessIsNotCoveredByTwoPartialBarriers) {
    // Sampled in compute and uniform in vertex are visible; sampled in vertex is not.
    const auto use = [](Access access, Stages stages) {
        return Use{.memory = buffer, .access = access, .stages = stages};
    };
    EXPECT_THAT(counts({scope({compute(buffer, Access::storage_write)}),
                        scope({use(Access::storage_read, Stages::compute)}),
                        scope({use(Access::uniform_read, Stages::vertex)}),
                        scope({use(Access::storage_read, Stages::vertex)})}),
                ElementsAre(0, 1, 1, 1));
}

TEST(Plan, WriteAfterReadAndWriteAfterWriteWait) {
    const Use write = compute(buffer, Access::storage_write);
    EXPECT_THAT(counts({scope({compute(buffer, Access::storage_read)}), scope({write}), scope({write})}),
                ElementsAre(0, 1, 1));
}

TEST(Plan, TheSameDispatchTwiceWaitsForItself) {
    const Scope step = scope({compute(buffer, atomic)});
    EXPECT_THAT(counts({step, step, step}), ElementsAre(0, 1, 1));
}

TEST(Plan, MipsOfOneTextureAreApart) {
    const auto read = [](MemoryId mip) { return compute(mip, Access::sampled_read, Layout::general); };
    const auto write = [](MemoryId mip) { return compute(mip, Access::storage_write, Layout::general); };
    EXPECT_THAT(
        counts({scope({write(mip0)}), scope({write(mip1)}), scope({read(mip0)}), scope({write(mip1)})}),
        ElementsAre(1, 1, 1, 1));
    EXPECT_THAT(counts({scope({write(mip0), write(mip1)}), scope({read(mip0)}), scope({read(mip0)})}),
                ElementsAre(2, 1, 0));
}

TEST(Plan, ReadsInDifferentLayoutsTakeATransition) {
    const std::vector<Scope> scopes{
        scope({compute(mip0, Access::copy_write, Layout::copy_destination)}),
        scope({compute(mip0, Access::sampled_read, Layout::read_only)}),
        scope({{.memory = mip0, .access = Access::copy_read, .layout = Layout::copy_source}}),
        scope({compute(mip0, Access::sampled_read, Layout::read_only)})};
    EXPECT_THAT(counts(scopes), ElementsAre(1, 1, 1, 1));
    const Barrier last = plan_barriers(scopes)[3].front();
    EXPECT_EQ(last.before_layout, Layout::copy_source);
    EXPECT_EQ(last.after_layout, Layout::read_only);
    EXPECT_TRUE(has(last.before, Access::copy_read));
    EXPECT_FALSE(has(last.before, Access::sampled_read)) << "the transition before it waited for that";
    EXPECT_TRUE(has(last.before, Access::copy_write))
        << "an API without layouts still has to flush the write";
}

TEST(Plan, FirstUseOfATextureComesFromUndefined) {
    Use target{.memory = mip0, .access = Access::color_attachment, .layout = Layout::color_attachment};
    target.discard = true;
    const std::vector<Scope> scopes{scope({target})};
    const auto plan = plan_barriers(scopes);
    EXPECT_THAT(plan[0], ElementsAre(Barrier{.memory = mip0,
                                             .after = Access::color_attachment,
                                             .after_layout = Layout::color_attachment,
                                             .discard = true}));
}

TEST(Plan, UnorderedSkipsBarriersBetweenCommutativeUsesAlone) {
    const Scope add = scope({count(buffer)}, true);
    const Use read = compute(buffer, Access::storage_read);
    EXPECT_THAT(counts({add, add, add}), ElementsAre(0, 0, 0));
    EXPECT_THAT(counts({scope({count(buffer)}), scope({count(buffer)})}), ElementsAre(0, 1));
    EXPECT_THAT(counts({scope({compute(buffer, Access::copy_write)}), add, add, scope({read}), add}),
                ElementsAre(0, 1, 0, 1, 1));
    EXPECT_THAT(counts({scope({compute(buffer, atomic)}), scope({compute(buffer, atomic)}, true)}),
                ElementsAre(0, 1))
        << "not by atomics alone";
}

TEST(Plan, AnUnorderedUseFromAnotherStageStillWaitsForWhatCameBeforeTheRun) {
    Use drawn = count(buffer);
    drawn.stages = Stages::fragment;
    EXPECT_THAT(counts({scope({compute(buffer, Access::copy_write)}), scope({count(buffer)}, true),
                        scope({drawn}, true)}),
                ElementsAre(0, 1, 1));
}

TEST(Plan, ForgottenResourcesStartAnew) {
    HazardTracker tracker;
    const Scope write = scope({compute(mip0, Access::storage_write, Layout::general),
                               compute(mip1, Access::storage_write, Layout::general),
                               compute(buffer, Access::storage_write)});
    EXPECT_THAT(tracker.enter(write), SizeIs(2));
    EXPECT_THAT(tracker.enter(write), SizeIs(3));
    tracker.forget(MemoryId::Kind::texture, mip0.index);
    const auto barriers = tracker.enter(write);
    ASSERT_THAT(barriers, SizeIs(3));
    EXPECT_EQ(barriers[0].before, Access::storage_write) << "the buffer has the same index and stays known";
    EXPECT_EQ(barriers[1].before, Access::none);
    EXPECT_EQ(barriers[2].before, Access::none);
}

TEST(MergeUses, UnitesReads) {
    Use vertex{.memory = buffer, .access = Access::storage_read, .stages = Stages::vertex};
    std::vector uses{compute(other, Access::uniform_read), vertex, compute(buffer, Access::uniform_read)};
    EXPECT_FALSE(merge_uses(uses));
    EXPECT_THAT(uses, ElementsAre(Use{.memory = buffer,
                                      .access = Access::storage_read | Access::uniform_read,
                                      .stages = Stages::vertex | Stages::compute},
                                  compute(other, Access::uniform_read)));
}

TEST(MergeUses, TakesTheGeneralLayoutWhereReadsDisagree) {
    const Use copied{.memory = mip0, .access = Access::copy_read, .layout = Layout::copy_source};
    std::vector uses{copied, compute(mip0, Access::sampled_read, Layout::read_only)};
    EXPECT_FALSE(merge_uses(uses));
    ASSERT_THAT(uses, SizeIs(1));
    EXPECT_EQ(uses[0].layout, Layout::general);
}

TEST(MergeUses, ObjectsToAWriteBesideAnotherUse) {
    const Use read = compute(buffer, Access::storage_read);
    const Use write = compute(buffer, Access::storage_write);
    const auto in_command = [](std::vector<Use> uses) { return merge_uses(uses).has_value(); };
    const auto in_draws = [](const std::vector<Use>& uses) {
        std::vector<Use> pass;
        return std::ranges::any_of(uses, [&](const Use& use) {
            return merge_draw(pass, {&use, 1}).has_value();
        });
    };
    for (const std::function<bool(std::vector<Use>)>& conflicts :
         std::initializer_list<std::function<bool(std::vector<Use>)>>{in_command, in_draws}) {
        EXPECT_TRUE(conflicts({read, write}));
        EXPECT_TRUE(conflicts({write, count(buffer)}));
        EXPECT_TRUE(conflicts({compute(buffer, atomic), compute(buffer, atomic)}));
        EXPECT_FALSE(conflicts({count(buffer), count(buffer), count(buffer)}));
        EXPECT_FALSE(conflicts({read, read}));
        EXPECT_FALSE(conflicts({write, compute(other, Access::storage_read)}));
    }
    EXPECT_TRUE(in_command({write, write}));
    EXPECT_FALSE(in_draws({write, write}));
    EXPECT_TRUE(in_draws({write, write, read}));
    std::vector uses{read, write};
    EXPECT_EQ(merge_uses(uses), buffer);
}

TEST(MergeUses, LeavesThePassAsItWasWhereADrawMustNotJoinIt) {
    const std::vector before{compute(other, Access::storage_read), compute(buffer, Access::storage_write)};
    std::vector<Use> pass = before;
    std::ranges::sort(pass, {}, &Use::memory);
    const std::vector<Use> as_it_was = pass;
    const std::vector draw{compute(buffer, Access::storage_read),
                           compute(mip0, Access::sampled_read, Layout::read_only)};
    EXPECT_EQ(merge_draw(pass, draw), buffer);
    EXPECT_EQ(pass, as_it_was);
}

TEST(PlanText, NamesMemoryAndShowsTransitions) {
    const std::vector<Scope> scopes{
        {"fill/program", {compute(mip0, Access::storage_write, Layout::general), count(buffer)}, false},
        {"show/program", {compute(mip0, Access::sampled_read, Layout::general)}, true}};
    const std::map<MemoryId, std::string> names{{mip0, "\"volume\" mip 0"}, {buffer, "\"counter\""}};
    EXPECT_EQ(to_text(scopes, plan_barriers(scopes), names),
              "fill/program: \"counter\" storage_read|storage_write@compute commutative, \"volume\" mip 0 "
              "storage_write@compute\n"
              "    \"volume\" mip 0: nothing -> storage_write@compute, undefined -> general\n"
              "show/program (unordered): \"volume\" mip 0 sampled@compute\n"
              "    \"volume\" mip 0: storage_write@compute -> sampled@compute\n");
    EXPECT_THAT(to_text(scopes, plan_barriers(scopes)), HasSubstr("texture 1 mip 0: nothing"));
}

// -- the mutation test: any barrier taken away, or made to reach less, leaves a hazard

/// A barrier in front of an ordered write with one access or stage less on its later side. (In front of a
/// read, part of the later side may have seen the last write already; and unordered uses may do without.)
std::vector<Barrier> weakened(const Scope& scope, const Barrier& barrier) {
    std::vector<Barrier> weaker;
    if (!is_write(barrier.after) || scope.unordered) return weaker;
    for (int bit = 0; bit < 16; ++bit) {
        const auto access = Access(1u << bit);
        if (!has(barrier.after, access)) continue;
        weaker.push_back(barrier);
        weaker.back().after = Access(uint16_t(barrier.after) & ~uint16_t(access));
    }
    for (int bit = 0; bit < 4; ++bit) {
        const auto stage = Stages(1u << bit);
        if (!has(barrier.after_stages, stage)) continue;
        weaker.push_back(barrier);
        weaker.back().after_stages = Stages(uint8_t(barrier.after_stages) & ~uint8_t(stage));
    }
    return weaker;
}

void expect_every_barrier_counts(const std::vector<Scope>& scopes) {
    const auto plan = plan_barriers(scopes);
    ASSERT_THAT(find_hazards(scopes, plan), IsEmpty()) << to_text(scopes, plan);
    auto mutant = plan;
    for (size_t i = 0; i < plan.size(); ++i) {
        for (size_t j = 0; j < plan[i].size(); ++j) {
            mutant[i].erase(mutant[i].begin() + std::ptrdiff_t(j));
            ASSERT_FALSE(find_hazards(scopes, mutant).empty())
                << "without barrier " << j << " of scope " << i << "\n"
                << to_text(scopes, plan);
            mutant[i] = plan[i];
            for (const Barrier& weaker : weakened(scopes[i], plan[i][j])) {
                mutant[i][j] = weaker;
                ASSERT_FALSE(find_hazards(scopes, mutant).empty())
                    << "with a weaker barrier " << j << " of scope " << i << "\n"
                    << to_text(scopes, mutant);
            }
            mutant[i] = plan[i];
        }
    }
}

TEST(PlanMutation, AFrameOfVoxelLighting) {
    const auto draw = [](MemoryId memory, Access access, Stages stages, Layout layout = Layout::undefined) {
        return Use{.memory = memory, .access = access, .stages = stages, .layout = layout};
    };
    const MemoryId volume{MemoryId::Kind::texture, 7, 0};
    const MemoryId half{MemoryId::Kind::texture, 7, 1};
    const MemoryId shadow{MemoryId::Kind::texture, 8, 0};
    const MemoryId color{MemoryId::Kind::texture, 9, 0};
    Use voxelize = draw(other, atomic, Stages::fragment);
    voxelize.commutative = true;
    Use depth = draw(shadow, Access::depth_attachment, Stages::none, Layout::depth_attachment);
    depth.discard = true;
    expect_every_barrier_counts({
        scope({compute(buffer, Access::copy_write), compute(other, Access::copy_write)}),
        scope({draw(buffer, Access::storage_read, Stages::vertex), voxelize}),
        scope({depth, draw(buffer, Access::storage_read, Stages::vertex)}),
        scope(
            {compute(other, Access::storage_read), compute(volume, Access::storage_write, Layout::general)}),
        scope({compute(shadow, Access::sampled_read, Layout::read_only),
               compute(volume, atomic, Layout::general)}),
        scope({compute(volume, Access::sampled_read, Layout::general),
               compute(half, Access::storage_write, Layout::general)}),
        scope({compute(volume, Access::sampled_read, Layout::general),
               compute(half, Access::sampled_read, Layout::general),
               compute(color, Access::storage_write, Layout::general)}),
        scope({draw(color, Access::copy_read, Stages::none, Layout::copy_source)}),
        scope({depth, draw(buffer, Access::storage_read, Stages::vertex)}),
        scope({draw(color, Access::sampled_read, Stages::fragment, Layout::general)}),
    });
}

class RandomPlan {
  public:
    explicit RandomPlan(uint32_t seed) : random_(seed) {}

    std::vector<Scope> scopes(size_t length) {
        std::vector<Scope> scopes;
        for (size_t i = 0; i < length; ++i) {
            std::vector<Use> uses;
            for (uint32_t index = 0; index < 2; ++index) {
                if (chance(2)) uses.push_back(buffer_use(index));
                if (chance(2)) uses.push_back(texture_use(index));
            }
            scopes.push_back({"scope " + std::to_string(i), std::move(uses), chance(2)});
        }
        return scopes;
    }

  private:
    bool chance(uint32_t of) { return random_() % of == 0; }
    template <class T, size_t N>
    T pick(const T (&from)[N]) {
        return from[random_() % N];
    }

    Stages stages() { return Stages(1 + random_() % 15); }

    Use shader_use(MemoryId memory, Access access, Layout layout) {
        return {.memory = memory, .access = access, .stages = stages(), .layout = layout};
    }

    Use atomics(MemoryId memory, Layout layout) {
        Use use{.memory = memory, .access = atomic, .stages = Stages::compute, .layout = layout};
        if (chance(3)) use.stages = Stages::fragment;
        use.commutative = !chance(4);
        return use;
    }

    Use buffer_use(uint32_t index) {
        const MemoryId memory{MemoryId::Kind::buffer, index, 0};
        if (chance(3)) return atomics(memory, Layout::undefined);
        if (chance(2))
            return shader_use(memory,
                              pick({Access::storage_read, Access::storage_write, Access::uniform_read,
                                    Access::storage_read | Access::uniform_read, atomic}),
                              Layout::undefined);
        return {.memory = memory,
                .access = pick({Access::copy_read, Access::copy_write, Access::index_read,
                                Access::indirect_read, Access::copy_read | Access::copy_write})};
    }

    Use texture_use(uint32_t index) {
        // Texture 0 is stored to, texture 1 is only sampled: that decides its layout in shaders.
        const MemoryId memory{MemoryId::Kind::texture, index, uint32_t(random_() % 2)};
        const Layout layout = index == 0 ? Layout::general : Layout::read_only;
        Use use;
        switch (random_() % 6) {
            case 0:
                use = {.memory = memory, .access = Access::copy_read, .layout = Layout::copy_source};
                break;
            case 1:
                use = {.memory = memory, .access = Access::copy_write, .layout = Layout::copy_destination};
                use.discard = chance(2);
                break;
            case 2:
                use = {
                    .memory = memory, .access = Access::color_attachment, .layout = Layout::color_attachment};
                use.discard = chance(2);
                break;
            case 3:
                if (index == 0) return atomics(memory, layout);
                [[fallthrough]];
            case 4:
                if (index == 0)
                    return shader_use(memory, pick({Access::storage_write, Access::storage_read}), layout);
                [[fallthrough]];
            default:
                use = shader_use(memory, Access::sampled_read, layout);
        }
        return use;
    }

    std::mt19937 random_;
};

TEST(PlanMutation, RandomSequences) {
    size_t barriers = 0;
    size_t scopes_without = 0;
    for (uint32_t seed = 0; seed < 400; ++seed) {
        const std::vector<Scope> scopes = RandomPlan(seed).scopes(4 + seed % 24);
        expect_every_barrier_counts(scopes);
        if (HasFatalFailure()) FAIL() << "seed " << seed;
        for (const auto& in_front : plan_barriers(scopes)) {
            barriers += in_front.size();
            scopes_without += in_front.empty();
        }
    }
    // The sequences are of the kind that tests something: many barriers, and many scopes that need none.
    EXPECT_GT(barriers, 4000u);
    EXPECT_GT(scopes_without, 500u);
}

TEST(FindHazards, SeesABarrierOfTheWrongMemory) {
    const std::vector<Scope> scopes{scope({compute(buffer, Access::storage_write)}),
                                    scope({compute(buffer, Access::storage_read)})};
    auto plan = plan_barriers(scopes);
    plan[1][0].memory = other;
    const auto hazards = find_hazards(scopes, plan);
    ASSERT_THAT(hazards, SizeIs(1));
    EXPECT_EQ(hazards[0].scope, 1u);
    EXPECT_EQ(hazards[0].memory, buffer);
}

TEST(FindHazards, SeesABarrierThatDoesNotWaitForTheWriter) {
    const std::vector<Scope> scopes{scope({compute(buffer, Access::storage_write)}),
                                    scope({compute(buffer, Access::storage_read)})};
    auto plan = plan_barriers(scopes);
    plan[1][0].before_stages = Stages::fragment;
    EXPECT_THAT(find_hazards(scopes, plan), SizeIs(1));
}

TEST(FindHazards, SeesAnExecutionDependencyThatFlushesNothing) {
    // The second barrier chains on the first but the first did not flush the write.
    const std::vector<Scope> scopes{scope({compute(buffer, Access::storage_write)}),
                                    scope({compute(buffer, Access::storage_read)})};
    auto plan = plan_barriers(scopes);
    plan[1][0].before = Access::storage_read;
    EXPECT_THAT(find_hazards(scopes, plan), SizeIs(1));
}

}  // namespace
}  // namespace lumo::rhi
