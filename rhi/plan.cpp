#include "rhi/plan.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace lumo::rhi {
namespace {

constexpr Reach everything = ~Reach{0};

}  // namespace

Reach reach_of(Access access, Stages stages) {
    // Four bits, a stage each, for each of the four accesses from uniform_read on; then a bit for each other one.
    constexpr int first_staged = 2, staged = 4, bits_a_stage = 4;
    const auto bits = Reach(access);
    Reach reach = 0;
    for (int i = 0; i < staged; ++i)
        if (bits >> (first_staged + i) & 1) reach |= Reach(stages) << (bits_a_stage * i);
    const Reach plain = (bits & ((1u << first_staged) - 1)) | bits >> (first_staged + staged) << first_staged;
    return reach | plain << (bits_a_stage * staged);
}
static_assert(Access::uniform_read == Access(1 << 2) && Access::storage_write == Access(1 << 5));

std::vector<Barrier> HazardTracker::enter(const Scope& scope) {
    std::vector<Barrier> barriers;
    enter(scope.uses, scope.unordered, barriers);
    return barriers;
}

void HazardTracker::enter(std::span<const Use> uses, bool unordered, std::vector<Barrier>& barriers) {
    const auto first = std::ptrdiff_t(barriers.size());
    for (const Use& use : uses) {
        Entry& entry = entry_of(use.memory);
        MemoryState& state = entry.now;
        if (std::exchange(entry.touched, mark_) != mark_) entry.at_mark = state;
        const bool writes = is_write(use.access);
        const bool moves = use.layout != state.layout;
        const Reach reach = reach_of(use.access, use.stages);
        const bool written = state.write != Access::none;
        const bool touched = written || state.reads != Access::none;
        const bool in_run = use.commutative && state.commutative && !moves && state.reads == Access::none;
        const bool joins_run = unordered && in_run && (reach & ~state.run_visible) == 0;
        const bool waits = moves || (writes ? touched && !joins_run
                                            : (written || state.moved) && (reach & ~state.visible) != 0);
        if (waits) {
            // Reads that only share the last write with this one need not end first, unless the barrier
            // changes the layout under them or has to wait, through them, for an earlier change.
            const bool after_reads = writes || moves || state.moved;
            barriers.push_back(
                {.memory = use.memory,
                 .before = after_reads ? state.write | state.reads : state.write,
                 .before_stages = after_reads ? state.write_stages | state.read_stages : state.write_stages,
                 .before_layout = state.layout,
                 .after = use.access,
                 .after_stages = use.stages,
                 .after_layout = use.layout,
                 .discard = use.discard});
        }
        if (writes && joins_run) {
            state.write |= use.access;
            state.write_stages |= use.stages;
        } else if (writes) {
            const Reach before_visible = in_run ? state.run_visible : Reach{0};
            state = {.write = use.access,
                     .write_stages = use.stages,
                     .layout = use.layout,
                     .commutative = use.commutative,
                     .run_visible = waits ? before_visible | reach : everything};
        } else {
            if (moves) {
                state.reads = Access::none;
                state.read_stages = Stages::none;
                state.visible = 0;
                state.layout = use.layout;
                state.moved = true;
            }
            state.reads |= use.access;
            state.read_stages |= use.stages;
            if (waits) state.visible |= reach;
        }
    }
    std::ranges::sort(barriers.begin() + first, barriers.end(), {}, &Barrier::memory);
}

Use external_use(const MemoryId& memory) {
    const bool texture = memory.kind == MemoryId::Kind::texture;
    return {.memory = memory,
            .access = Access::external,
            .layout = texture ? Layout::external : Layout::undefined};
}

void HazardTracker::adopt(const MemoryId& memory) {
    const Use use = external_use(memory);
    entry_of(memory).now = {.write = use.access, .layout = use.layout, .run_visible = everything};
}

void HazardTracker::forget(MemoryId::Kind kind, uint32_t index) {
    auto& by_index = states_[size_t(kind)];
    if (index < by_index.size()) by_index[index].clear();
}

void HazardTracker::rewind() {
    for (auto& by_index : states_)
        for (auto& by_mip : by_index)
            for (Entry& entry : by_mip)
                if (entry.touched == mark_) entry.now = entry.at_mark;
}

namespace {

bool may_meet(const Use& a, const Use& b) {
    return (!is_write(a.access) && !is_write(b.access)) || (a.commutative && b.commutative);
}

bool may_meet_in_draws(const Use& a, const Use& b) {
    return may_meet(a, b) || (a.access == Access::storage_write && b.access == Access::storage_write);
}

void unite(Use& whole, const Use& use) {
    whole.access |= use.access;
    whole.stages |= use.stages;
    if (whole.layout != use.layout) whole.layout = Layout::general;
    whole.discard = whole.discard && use.discard;
    whole.commutative = whole.commutative && use.commutative;
}

/// Where a memory's use is, or would be, among sorted ones.
auto place_of(std::vector<Use>& uses, const MemoryId& memory) {
    return std::ranges::lower_bound(uses, memory, {}, &Use::memory);
}

}  // namespace

std::optional<MemoryId> merge_uses(std::vector<Use>& uses) {
    std::optional<MemoryId> conflicting;
    std::ranges::sort(uses, {}, &Use::memory);
    size_t merged = 0;
    for (const Use& use : uses) {
        if (merged == 0 || uses[merged - 1].memory != use.memory) {
            uses[merged++] = use;
            continue;
        }
        Use& whole = uses[merged - 1];
        if (!may_meet(whole, use) && !conflicting) conflicting = use.memory;
        unite(whole, use);
    }
    uses.resize(merged);
    return conflicting;
}

std::optional<MemoryId> merge_draw(std::vector<Use>& pass, std::span<const Use> draw) {
    for (const Use& use : draw) {
        const auto place = place_of(pass, use.memory);
        if (place != pass.end() && place->memory == use.memory && !may_meet_in_draws(*place, use))
            return use.memory;
    }
    for (const Use& use : draw) {
        const auto place = place_of(pass, use.memory);
        if (place != pass.end() && place->memory == use.memory)
            unite(*place, use);
        else
            pass.insert(place, use);
    }
    return {};
}

bool may_repeat(std::span<const Use> draw) {
    return std::ranges::all_of(draw, [](const Use& use) { return may_meet_in_draws(use, use); });
}

std::vector<std::vector<Barrier>> plan_barriers(std::span<const Scope> scopes) {
    HazardTracker tracker;
    std::vector<std::vector<Barrier>> barriers;
    for (const Scope& scope : scopes) barriers.push_back(tracker.enter(scope));
    return barriers;
}

namespace {

/// `flags` as names joined by "|".
template <class Flags, size_t N>
std::string join(Flags flags, const std::array<std::pair<Flags, std::string_view>, N>& names) {
    std::string text;
    for (const auto& [flag, name] : names)
        if (has(flags, flag)) text += (text.empty() ? "" : "|") + std::string(name);
    return text;
}

std::string access_text(Access access, Stages stages) {
    static constexpr std::array<std::pair<Access, std::string_view>, 12> accesses{{
        {Access::indirect_read, "indirect"},
        {Access::index_read, "index"},
        {Access::uniform_read, "uniform"},
        {Access::sampled_read, "sampled"},
        {Access::storage_read, "storage_read"},
        {Access::storage_write, "storage_write"},
        {Access::color_attachment, "color"},
        {Access::depth_attachment, "depth"},
        {Access::copy_read, "copy_read"},
        {Access::copy_write, "copy_write"},
        {Access::host_read, "host_read"},
        {Access::external, "external"},
    }};
    static constexpr std::array<std::pair<Stages, std::string_view>, 4> stage_names{{
        {Stages::vertex, "vertex"},
        {Stages::geometry, "geometry"},
        {Stages::fragment, "fragment"},
        {Stages::compute, "compute"},
    }};
    if (access == Access::none) return "nothing";
    std::string text = join(access, accesses);
    if (stages != Stages::none) text += "@" + join(stages, stage_names);
    return text;
}

std::string_view layout_text(Layout layout) {
    switch (layout) {
        case Layout::undefined:
            return "undefined";
        case Layout::general:
            return "general";
        case Layout::read_only:
            return "read_only";
        case Layout::color_attachment:
            return "color_attachment";
        case Layout::depth_attachment:
            return "depth_attachment";
        case Layout::copy_source:
            return "copy_source";
        case Layout::copy_destination:
            return "copy_destination";
        case Layout::external:
            return "external";
    }
    return "unknown";
}

std::string memory_text(const MemoryId& memory, const std::map<MemoryId, std::string>& names) {
    if (auto name = names.find(memory); name != names.end()) return name->second;
    return memory.kind == MemoryId::Kind::buffer ? fmt::format("buffer {}", memory.index)
                                                 : fmt::format("texture {} mip {}", memory.index, memory.mip);
}

std::string barrier_text(const Barrier& barrier, const std::map<MemoryId, std::string>& names) {
    std::string text = fmt::format("{}: {} -> {}", memory_text(barrier.memory, names),
                                   access_text(barrier.before, barrier.before_stages),
                                   access_text(barrier.after, barrier.after_stages));
    if (barrier.before_layout != barrier.after_layout)
        text +=
            fmt::format(", {} -> {}", layout_text(barrier.before_layout), layout_text(barrier.after_layout));
    if (barrier.discard) text += ", discard";
    return text;
}

}  // namespace

std::string to_text(std::span<const Scope> scopes, std::span<const std::vector<Barrier>> barriers,
                    const std::map<MemoryId, std::string>& names) {
    std::string text;
    for (size_t i = 0; i < scopes.size(); ++i) {
        // Sorted as text: the numbers behind the names depend on when the device let go of older resources.
        std::vector<std::string> uses;
        for (const Use& use : scopes[i].uses)
            uses.push_back(memory_text(use.memory, names) + " " + access_text(use.access, use.stages) +
                           (use.commutative ? " commutative" : ""));
        std::vector<std::string> lines;
        for (const Barrier& barrier : barriers[i]) lines.push_back(barrier_text(barrier, names));
        std::ranges::sort(uses);
        std::ranges::sort(lines);
        text += fmt::format("{}{}: {}\n", scopes[i].label, scopes[i].unordered ? " (unordered)" : "",
                            fmt::join(uses, ", "));
        for (const std::string& line : lines) text += "    " + line + "\n";
    }
    return text;
}

}  // namespace lumo::rhi
