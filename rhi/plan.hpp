// Hazards: which accesses to memory must wait for which, decided without any API.
//
// Work is a sequence of scopes: one dispatch, one copy, or one whole raster pass. A scope's uses of each
// buffer and each texture mip are compared with the last write and the reads since; read after write, write
// after read, write after write and changes of image layout ask for a barrier in front of the scope. Both
// backends get the same barriers. OpenGL needs those after incoherent shader writes alone; Vulkan needs all.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rhi/bindings.hpp"

namespace lumo::rhi {

/// Ways to touch memory, as bits.
enum class Access : uint16_t {
    none = 0,
    indirect_read = 1,
    index_read = 2,
    uniform_read = 4,
    sampled_read = 8,
    storage_read = 16,
    storage_write = 32,     ///< with storage_read where it also reads; atomics are both
    color_attachment = 64,  ///< reads and writes
    depth_attachment = 128,
    copy_read = 256,
    copy_write = 512,
    host_read = 1024,
    external = 2048,  ///< all that a host does with its own texture between submissions
};
template <>
inline constexpr bool is_flags<Access> = true;

inline constexpr Access write_accesses = Access::storage_write | Access::color_attachment |
                                         Access::depth_attachment | Access::copy_write | Access::external;

constexpr bool is_write(Access access) { return has(access, write_accesses); }

/// A buffer, or one mip of a texture with all its layers.
struct MemoryId {
    enum class Kind : uint8_t { buffer, texture } kind = Kind::buffer;
    uint32_t index = 0;  ///< of the resource's handle
    uint32_t mip = 0;

    // clang-tidy 14 takes the defaulted comparison for a null pointer.
    auto operator<=>(const MemoryId&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// How a texture's mip lies in memory while it is used. Buffers stay undefined.
enum class Layout : uint8_t {
    undefined,
    general,
    read_only,
    color_attachment,
    depth_attachment,
    copy_source,
    copy_destination,
    external  ///< what the host of a texture named (rhi/native.hpp)
};

struct Use {
    MemoryId memory;
    Access access = Access::none;
    Stages stages = Stages::none;       ///< the shader stages of uniform, sampled and storage accesses
    Layout layout = Layout::undefined;  ///< that the texture must have
    bool discard = false;               ///< all that it held before may be lost
    bool commutative = false;           ///< by atomics whose order does not matter

    bool operator==(const Use&) const = default;
};

/// What a host may do with its own between submissions.
Use external_use(const MemoryId& memory);

/// What happens between two sets of barriers. At most one use per memory.
struct Scope {
    std::string label;
    std::vector<Use> uses;
    bool unordered = false;  ///< its commutative uses need not wait for earlier commutative ones

    bool operator==(const Scope&) const = default;
};

/// `after` may start only when `before` is done, and sees what it wrote. Without a write in `before` it is an
/// execution dependency and, where the layouts differ, a layout transition.
struct Barrier {
    MemoryId memory;
    Access before = Access::none;  ///< none: first use, a transition from undefined
    Stages before_stages = Stages::none;
    Layout before_layout = Layout::undefined;
    Access after = Access::none;
    Stages after_stages = Stages::none;
    Layout after_layout = Layout::undefined;
    bool discard = false;  ///< the contents need not survive the transition

    bool operator==(const Barrier&) const = default;
};

/// Pairs of one access and one shader stage, as bits: what a barrier's two sides are made of. Accesses that
/// are not by shaders have one bit each.
using Reach = uint32_t;
Reach reach_of(Access access, Stages stages);

/// What is remembered of one memory: its last write, the reads since, its layout.
struct MemoryState {
    Access write = Access::none;
    Stages write_stages = Stages::none;
    Access reads = Access::none;
    Stages read_stages = Stages::none;
    Reach visible = 0;  ///< what barriers have made the last write visible to
    Layout layout = Layout::undefined;
    bool moved = false;        ///< its layout changed after the last write, for a read
    bool commutative = false;  ///< the last write was
    Reach run_visible = 0;     ///< what all that came before the last run of commutative writes is visible to
};

/// The state of all memory between scopes.
class HazardTracker {
  public:
    /// The barriers that `scope` needs in front of it, sorted by memory; then counts the scope as done.
    std::vector<Barrier> enter(const Scope& scope);
    /// The same for a scope of these uses, at the end of `barriers`.
    void enter(std::span<const Use> uses, bool unordered, std::vector<Barrier>& barriers);
    /// A buffer or a texture's mip is in the hands of its host.
    void adopt(const MemoryId& memory);
    /// Forgets a destroyed resource.
    void forget(MemoryId::Kind kind, uint32_t index);

    /// Scopes entered from here on can be taken back.
    void mark() { ++mark_; }
    /// Takes back the scopes entered since the mark: they never ran.
    void rewind();

  private:
    struct Entry {
        MemoryState now;
        MemoryState at_mark;  ///< valid where `touched` is the current mark
        uint64_t touched = 0;
    };
    Entry& entry_of(const MemoryId& memory) {
        auto& by_index = states_[size_t(memory.kind)];
        if (memory.index >= by_index.size()) by_index.resize(memory.index + 1);
        auto& by_mip = by_index[memory.index];
        if (memory.mip >= by_mip.size()) by_mip.resize(memory.mip + 1);
        return by_mip[memory.mip];
    }

    std::array<std::vector<std::vector<Entry>>, 2> states_;  ///< by kind, index and mip; grown on first use
    uint64_t mark_ = 1;
};

/// Leaves one use per memory out of many of one command, sorted by memory: accesses and stages united; general
/// layout where they disagree. Returns the first memory whose uses must not meet: a write beside any other use,
/// unless all of that memory are commutative.
std::optional<MemoryId> merge_uses(std::vector<Use>& uses);

/// Adds the uses of a draw to those of the draws before it, both merged already. Draws may write the same memory,
/// to places of their own. Where uses must not meet, `pass` stays as it was.
std::optional<MemoryId> merge_draw(std::vector<Use>& pass, std::span<const Use> draw);
/// Whether any number of draws may have these uses.
bool may_repeat(std::span<const Use> draw);

/// Barriers in front of each scope, from nothing known.
std::vector<std::vector<Barrier>> plan_barriers(std::span<const Scope> scopes);

/// A hazard that a plan leaves open.
struct Hazard {
    size_t scope = 0;
    MemoryId memory;
    std::string why;
};

/// Checks a plan by another way than planning it: follows every pair of uses of the same memory and asks
/// whether the barriers between them order them and carry the layout. Empty when the plan is sound.
std::vector<Hazard> find_hazards(std::span<const Scope> scopes,
                                 std::span<const std::vector<Barrier>> barriers);

/// The plan as text, a line a scope and an indented line a barrier; names give memory its label.
std::string to_text(std::span<const Scope> scopes, std::span<const std::vector<Barrier>> barriers,
                    const std::map<MemoryId, std::string>& names = {});

}  // namespace lumo::rhi
