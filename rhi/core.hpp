// What stands behind Device, Commands and passes: everything of the RHI that needs no API.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rhi/arena.hpp"
#include "rhi/backend.hpp"
#include "rhi/plan.hpp"
#include "rhi/resource_table.hpp"
#include "rhi/rhi.hpp"
#include "rhi/staging.hpp"
#include "rhi/validate.hpp"

namespace lumo::rhi {

/// An error that came up in something larger.
inline Error within(std::string_view where, const Error& error) {
    if (error.subject == where) return error;
    return {error.kind, std::string(where), to_string(error), {}};
}

/// Errors of commands reach the message sink when they happen; what is returned as well is for callers that
/// have someone to hand it to.
class DeviceCore {
  public:
    using AnyDraw = std::variant<Draw, DrawIndexed, DrawIndirect>;

    DeviceCore(std::unique_ptr<Backend> backend, MessageSink sink);
    ~DeviceCore();

    // -- resources
    const DeviceInfo& info() const { return backend_->info(); }
    FormatCaps format_caps(Format format) const { return backend_->format_caps(format); }
    Result<Buffer> create_buffer(const BufferDesc& desc);
    Result<Texture> create_texture(const TextureDesc& desc);
    Result<Sampler> create_sampler(const SamplerDesc& desc);
    Result<Texture> adopt_texture(const TextureDesc& desc, const NativeTexture& native);
    Result<Buffer> adopt_buffer(const BufferDesc& desc, const NativeBuffer& native);
    Result<PipelineHandle> create_pipeline(const ProgramInfo& program, std::span<const uint32_t> options,
                                           const RasterState* raster);
    /// For owners; the last one to go after the device takes the core with it.
    template <class HandleType>
    void release(HandleType handle);

    // -- submissions
    uint64_t begin();
    Submission submit(uint64_t serial);
    Result<void> wait(uint64_t serial);
    bool finished(uint64_t serial) { return lost_ || serial <= backend_->completed(); }
    Result<std::vector<std::byte>> take(Readback readback);
    std::vector<PassTime> pass_times(uint64_t serial);
    std::string trace(uint64_t serial) const;
    void set_tracing(bool on) { tracing_ = on; }
    /// Waits for the device, reports what is still owned, and lets go of it. True when nobody owned anything.
    bool close();

    std::vector<MemoryEntry> memory() const { return resources_.memory(); }
    MemoryBudget memory_budget() const { return backend_->memory_budget(); }
    void report(const Message& message) const;

    // -- passes: by the submission's serial, then by the pass's id; 0 for what could not be opened
    bool recording(uint64_t serial);
    uint64_t open_pass(uint64_t serial, std::string_view name);
    uint64_t open_raster_pass(uint64_t serial, std::string_view name, const RasterTargets& targets);
    void end_pass(uint64_t id);
    Result<BufferSlice> uniform(uint64_t serial, std::span<const std::byte> bytes);
    Result<void> present(uint64_t serial, TextureHandle texture, bool vsync);
    Result<void> wait_for(uint64_t serial, const NativeSync& sync);
    Result<void> signal(uint64_t serial, const NativeSync& sync);

    Result<void> dispatch(uint64_t id, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                          std::span<const std::byte> push, Groups groups);
    Result<void> dispatch_indirect(uint64_t id, PipelineHandle pipeline,
                                   std::span<const BindingValue> bindings, std::span<const std::byte> push,
                                   BufferSlice arguments, bool unordered);
    Result<void> copy(uint64_t id, BufferSlice source, BufferSlice destination);
    Result<void> copy(uint64_t id, TextureHandle source, const TextureRegion& source_region,
                      TextureHandle destination, const TextureRegion& destination_region);
    Result<void> upload(uint64_t id, BufferSlice destination, std::span<const std::byte> bytes);
    Result<void> upload(uint64_t id, TextureHandle destination, const TextureRegion& region,
                        std::span<const std::byte> texels);
    Result<void> fill(uint64_t id, BufferSlice destination, uint32_t value);
    Result<void> clear(uint64_t id, const TextureView& view, const ClearValue& value);
    Result<void> generate_mips(uint64_t id, TextureHandle texture);
    Result<Readback> read(uint64_t id, BufferSlice source);
    Result<Readback> read(uint64_t id, TextureHandle source, const TextureRegion& region);

    Result<void> draw(uint64_t id, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                      std::span<const std::byte> push, const AnyDraw& draw);
    Result<void> viewport(uint64_t id, const Viewport& viewport);

    /// Reports why a command is dropped. What the environment refused fails the open submission as well.
    tl::unexpected<Error> drop(std::string_view where, const Fault& fault);

  private:
    /// The pass that is open. Its memory serves the passes after it.
    struct OpenPass {
        uint64_t id = 0;
        std::string name;
        bool raster = false;
        RasterTargets targets;
        std::vector<Step> steps;
        std::vector<Use> uses;      ///< of a raster pass so far
        Arena arena;                ///< bindings, push constants and barriers of its steps
        std::vector<Scope> scopes;  ///< for the trace, with their barriers
        std::vector<std::vector<Barrier>> barriers;

        void clear();
    };
    /// Bindings of a pass, checked and kept. What binds the same again in this pass is not checked again.
    struct BoundSet {
        PipelineHandle pipeline;
        const ProgramInfo* program = nullptr;
        std::span<const BindingValue> bindings;
        std::span<const Use> uses;  ///< merged
        uint64_t pass = 0;
        uint64_t releases = 0;  ///< of resources, before it was checked
        bool joined = false;    ///< the raster pass has its uses, and one more draw may have them

        PipelineBindings with(std::span<const std::byte> push) const { return {pipeline, bindings, push}; }
    };
    /// What is kept of a submission for those who ask later.
    struct Record {
        std::vector<std::string> passes;
        std::string trace;
        std::optional<Error> failure;  ///< the first thing that the environment refused it
    };

    /// Runs `body` (OpenPass& -> Verdict) on pass `id` if that is open, and reports what it finds.
    template <class Body>
    Result<void> record(uint64_t id, Body body) {
        if (lost_) return tl::unexpected(*lost_);
        if (!pass_ || id == 0 || pass_->id != id)
            return drop("pass", {Check::commands_spent, "it has ended, or could not be opened"});
        Verdict bad = body(*pass_);
        if (bad) return drop(pass_->name, *bad);
        return {};
    }
    /// Reports what the environment refused, and fails the submission of that serial, if any, with it. The first
    /// loss of the device is reported so, and is the error of every later call.
    tl::unexpected<Error> refuse(uint64_t serial, Error error);
    /// Waits without asking whether the submission did all that it should.
    Result<void> finish(uint64_t serial);
    /// What `make` creates, unless the device is lost.
    template <class Make>
    auto create(Make make) -> decltype(make());
    /// One to open: an earlier one's memory, or a new one.
    std::unique_ptr<OpenPass> blank_pass();
    uint64_t start_pass(uint64_t serial, std::string_view name, std::unique_ptr<OpenPass> pass);
    void add(OpenPass& pass, std::string_view what, std::span<const Use> uses, bool unordered,
             const Command& command);
    /// The barriers of a scope, until the next is entered. It is `what` of the pass in the trace, if anything.
    std::span<const Barrier> enter(OpenPass& pass, std::string_view what, std::span<const Use> uses,
                                   bool unordered);
    /// For the uses of one command.
    std::vector<Use>& no_uses() {
        uses_.clear();
        return uses_;
    }
    std::vector<Barrier> hand_back();
    void keep_trace(std::span<const Scope> scopes, std::span<const std::vector<Barrier>> barriers);

    /// Finds what is bound among the pass's sets, or checks and keeps it.
    Verdict bind(OpenPass& pass, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                 std::span<const std::byte> push, BoundSet*& bound);
    Verdict check_set(OpenPass& pass, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                      BoundSet& set);
    Verdict bind_one(const BindingInfo& info, const BindingValue& value, std::vector<Use>& uses);
    Verdict check_targets(RasterTargets& targets, std::vector<Use>& uses);
    Verdict check_draw_targets(const OpenPass& pass, const PipelineRecord& pipeline) const;
    Verdict use_slice(const BufferSlice& slice, BufferUsage usage, Access access, uint64_t alignment,
                      std::vector<Use>& uses);
    Verdict use_draw(const Draw& draw, const PipelineBindings& what, std::vector<Use>& uses,
                     Command& command);
    Verdict use_draw(const DrawIndexed& draw, const PipelineBindings& what, std::vector<Use>& uses,
                     Command& command);
    Verdict use_draw(const DrawIndirect& draw, const PipelineBindings& what, std::vector<Use>& uses,
                     Command& command);
    Verdict conflict(const MemoryId& memory) const;
    Verdict stage(std::span<const std::byte> bytes, uint64_t alignment, BufferSlice& slice);
    Use texture_use(const TextureView& view, uint32_t mip, Access access, bool discard = false);
    /// What releases now wait for.
    uint64_t last_serial() const { return open_serial_ ? open_serial_ : submitted_; }

    std::unique_ptr<Backend> backend_;
    MessageSink sink_;
    ResourceTable resources_;
    UploadRing uploads_;
    ReadbackPool readbacks_;
    HazardTracker tracker_;

    uint64_t submitted_ = 0;
    uint64_t open_serial_ = 0;     ///< 0 while nothing is recorded
    bool presented_ = false;       ///< in the open submission
    std::set<MemoryId> borrowed_;  ///< what the open submission used of the host's, all mips
    bool idle_ = false;            ///< the open submission was refused: nothing of it runs
    std::optional<Error> lost_;
    uint64_t last_pass_ = 0;
    std::unique_ptr<OpenPass> pass_, blank_;
    std::vector<Use> uses_;
    std::vector<Barrier> barriers_;
    std::array<BoundSet, 64> bound_sets_;  ///< by a hash of what is bound
    std::map<uint64_t, Record> records_;
    bool tracing_ = false;
    size_t owners_ = 0;
    bool closed_ = false;
};

}  // namespace lumo::rhi
