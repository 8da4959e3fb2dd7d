// The plan's checker. It shares no rule with the planner: it knows only what a barrier promises, and follows
// each access, bit by bit, through the barriers behind it to every later use of the same memory.
#include <fmt/format.h>
#include <map>
#include <string>
#include <vector>

#include "rhi/plan.hpp"

namespace lumo::rhi {
namespace {

/// A barrier or a use of one memory, in order.
struct Event {
    size_t scope;
    const Barrier* barrier;
    const Use* use;

    bool moves() const { return barrier && barrier->before_layout != barrier->after_layout; }
};

/// What is known to come after one access (or one change of layout), and to see what it wrote.
struct Flow {
    Reach source = 0;  ///< one bit, or none for a change of layout
    bool wrote = false;
    bool available = false;
    Reach ordered = 0;
    Reach visible = 0;

    bool waited_for_by(const Barrier& barrier) const {
        return (reach_of(barrier.before, barrier.before_stages) & (source | ordered)) != 0;
    }
    void pass(const Barrier& barrier) {
        if (!waited_for_by(barrier)) return;
        const Reach after = reach_of(barrier.after, barrier.after_stages);
        available = available || (reach_of(barrier.before, barrier.before_stages) & source) != 0;
        ordered |= after;
        if (available) visible |= after;
    }
    bool reaches(Reach reach) const { return (reach & ~ordered) == 0 && (!wrote || (reach & ~visible) == 0); }
};

constexpr Reach each_bit = 32;

class MemoryCheck {
  public:
    MemoryCheck(std::span<const Scope> scopes, MemoryId memory, std::span<const Event> events,
                std::vector<Hazard>& hazards)
        : scopes_(scopes), memory_(memory), events_(events), hazards_(hazards) {}

    void run() {
        check_layouts();
        for (size_t i = 0; i < events_.size(); ++i) {
            if (events_[i].use)
                follow_use(i);
            else if (events_[i].moves())
                follow_move(i);
        }
    }

  private:
    void object(size_t scope, std::string why) { hazards_.push_back({scope, memory_, std::move(why)}); }

    void check_layouts() {
        Layout layout = Layout::undefined;
        for (const Event& event : events_) {
            if (event.barrier) {
                if (event.barrier->before_layout != layout)
                    object(event.scope, "a barrier starts from a layout that the texture does not have");
                layout = event.barrier->after_layout;
            } else if (event.use->layout != layout) {
                object(event.scope, "the texture is not in the layout of its use");
            }
        }
    }

    void follow_use(size_t start) {
        const Use& use = *events_[start].use;
        const Access writes = Access(uint16_t(use.access) & uint16_t(write_accesses));
        const Reach all = reach_of(use.access, use.stages);
        const Reach writing = reach_of(writes, use.stages);
        for (Reach bit = 0; bit < each_bit; ++bit) {
            const Reach source = Reach{1} << bit;
            if (!(all & source)) continue;
            follow(start, {.source = source, .wrote = (writing & source) != 0}, &use);
        }
    }

    void follow_move(size_t start) {
        const Barrier& barrier = *events_[start].barrier;
        const Reach after = reach_of(barrier.after, barrier.after_stages);
        follow(start, {.wrote = true, .available = true, .ordered = after, .visible = after}, nullptr);
    }

    /// `from` is null for a change of layout, which everything later must come after.
    void follow(size_t start, Flow flow, const Use* from) {
        for (const Event& event : events_.subspan(start + 1)) {
            if (event.barrier) {
                if (event.moves() && !flow.waited_for_by(*event.barrier)) {
                    object(event.scope, fmt::format("its layout changes without waiting for scope {}",
                                                    events_[start].scope));
                    return;
                }
                flow.pass(*event.barrier);
                if (event.moves() && !event.barrier->discard && flow.wrote && !flow.available) {
                    object(event.scope,
                           fmt::format("its layout changes before the write of scope {} is flushed",
                                       events_[start].scope));
                    return;
                }
            } else if (must_wait(from, event) &&
                       !flow.reaches(reach_of(event.use->access, event.use->stages))) {
                object(event.scope, fmt::format("it does not wait for scope {}", events_[start].scope));
                return;
            }
        }
    }

    bool must_wait(const Use* from, const Event& event) const {
        if (!from) return true;
        if (!is_write(from->access) && !is_write(event.use->access)) return false;
        return !(from->commutative && event.use->commutative && scopes_[event.scope].unordered);
    }

    std::span<const Scope> scopes_;
    MemoryId memory_;
    std::span<const Event> events_;
    std::vector<Hazard>& hazards_;
};

}  // namespace

std::vector<Hazard> find_hazards(std::span<const Scope> scopes,
                                 std::span<const std::vector<Barrier>> barriers) {
    std::map<MemoryId, std::vector<Event>> events;
    for (size_t i = 0; i < scopes.size(); ++i) {
        for (const Barrier& barrier : barriers[i]) events[barrier.memory].push_back({i, &barrier, nullptr});
        for (const Use& use : scopes[i].uses) events[use.memory].push_back({i, nullptr, &use});
    }
    std::vector<Hazard> hazards;
    for (const auto& [memory, sequence] : events) MemoryCheck(scopes, memory, sequence, hazards).run();
    return hazards;
}

}  // namespace lumo::rhi
