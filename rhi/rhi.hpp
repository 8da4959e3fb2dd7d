// The render-hardware interface: what a technique may say to a GPU.
//
//     auto volume = device.create_texture({.name = "voxels", .dimension = Dimension::d3, …});
//     auto mips = device.create_compute_pipeline<shaders::voxels::mips>();
//     Commands commands = device.begin();
//     {
//         Pass pass = commands.pass("voxels.mips");
//         pass.dispatch(*mips, {.source = …, .destination = …}, {.level = 1}, {32, 32, 32});
//     }
//     Submission done = device.submit(std::move(commands));
//
// A pass is the unit of barriers, timing and labels. Barriers are automatic (rhi/plan.hpp): every dispatch
// and copy is a scope of its own, a raster pass is one scope. What a program needs is a type that the shader
// compiler generated from its GLSL, so a missing or mistyped binding does not compile.
//
// Coordinates: row 0 of memory is NDC y = -1, depth is [0, 1], front faces are counter-clockwise, on both
// APIs. Only presenting and writing image files flip.
//
// Errors: what the environment causes is a Result; what it refuses to a command that returns none reaches the
// message sink, and whoever waits for the submission or takes its bytes. Out of memory leaves a device that goes
// on; a lost device is reported once, then every call says so. Misuse is a Check sent to the sink, and the
// command is dropped. Calls on a device, and on what it made, come from one thread at a time; devices
// share nothing.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rhi/check.hpp"
#include "rhi/device_info.hpp"
#include "rhi/error.hpp"
#include "rhi/native.hpp"
#include "rhi/resources.hpp"
#include "rhi/work.hpp"

namespace lumo::rhi {

class Backend;

/// Names one batch of work given to the device.
struct Submission {
    uint64_t serial = 0;
};

/// A promise of bytes copied from the device.
struct Readback {
    uint64_t id = 0;
};

struct PassTime {
    std::string name;
    double milliseconds = 0;  ///< between the pass's time stamps on the device
};

/// Device memory held by one resource.
struct MemoryEntry {
    std::string name;
    uint64_t bytes = 0;
};

/// What both kinds of pass share: a pass ends, and is handed to the device, when it goes out of scope.
class PassBase {
  public:
    PassBase(PassBase&& other) noexcept : core_(other.core_), id_(std::exchange(other.id_, 0)) {}
    PassBase& operator=(PassBase&&) = delete;
    ~PassBase() { end(); }
    void end();

  protected:
    PassBase(DeviceCore* core, uint64_t id) : core_(core), id_(id) {}
    DeviceCore* core_;  ///< null: the pass could not be opened, and drops what it is told
    uint64_t id_;       ///< 0 once ended
};

/// Compute and copies.
class Pass : public PassBase {
  public:
    template <Program P>
    void dispatch(const ComputePipeline<P>& pipeline, const typename P::Bindings& bindings,
                  const typename P::Push& push, Groups groups) {
        auto values = bindings.values();
        dispatch(pipeline.handle(), values, push_bytes(push), groups);
    }
    /// `arguments`: three uint32 group counts, from a buffer with BufferUsage::indirect.
    template <Program P>
    void dispatch_indirect(const ComputePipeline<P>& pipeline, const typename P::Bindings& bindings,
                           const typename P::Push& push, BufferSlice arguments, bool unordered = false) {
        auto values = bindings.values();
        dispatch_indirect(pipeline.handle(), values, push_bytes(push), arguments, unordered);
    }

    void copy(BufferSlice source, BufferSlice destination);
    /// Regions have equal extents and layer counts.
    void copy(const Texture& source, const TextureRegion& source_region, const Texture& destination,
              const TextureRegion& destination_region);
    /// Host bytes to the device, in order with the other commands; they are copied before this returns.
    void upload(BufferSlice destination, std::span<const std::byte> bytes);
    /// Tightly packed texels, row 0 first, then slices or layers.
    void upload(const Texture& destination, const TextureRegion& region, std::span<const std::byte> texels);
    /// Fills with one 32-bit word; offset and size are multiples of 4.
    void fill(BufferSlice destination, uint32_t value = 0);
    /// Fills one or more mips of a colour or depth texture. Through a view in another format than the
    /// texture's own, with zero alone.
    void clear(const TextureView& view, const ClearValue& value = std::array<float, 4>{});
    /// Each mip from the one above it by a linear filter of 2 texels a side.
    void generate_mips(const Texture& texture);
    /// Copies out; the bytes are there when the submission is done (Device::take).
    Readback read(BufferSlice source);
    Readback read(const Texture& source, const TextureRegion& region);

  private:
    friend class Commands;
    using PassBase::PassBase;
    template <class Push>
    static std::span<const std::byte> push_bytes(const Push& push) {
        if constexpr (std::is_same_v<Push, NoPush>) {
            return {};
        } else {
            return std::as_bytes(std::span(&push, 1));
        }
    }
    void dispatch(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                  std::span<const std::byte> push, Groups groups);
    void dispatch_indirect(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                           std::span<const std::byte> push, BufferSlice arguments, bool unordered);
    friend class RasterPass;
};

/// Draws into one set of targets. All draws are one scope: none may read what another writes, unless by
/// atomics.
class RasterPass : public PassBase {
  public:
    template <Program P>
    void draw(const RasterPipeline<P>& pipeline, const typename P::Bindings& bindings,
              const typename P::Push& push, const Draw& draw) {
        auto values = bindings.values();
        record(pipeline.handle(), values, Pass::push_bytes(push), draw);
    }
    template <Program P>
    void draw(const RasterPipeline<P>& pipeline, const typename P::Bindings& bindings,
              const typename P::Push& push, const DrawIndexed& draw) {
        auto values = bindings.values();
        record(pipeline.handle(), values, Pass::push_bytes(push), draw);
    }
    template <Program P>
    void draw(const RasterPipeline<P>& pipeline, const typename P::Bindings& bindings,
              const typename P::Push& push, const DrawIndirect& draw) {
        auto values = bindings.values();
        record(pipeline.handle(), values, Pass::push_bytes(push), draw);
    }
    /// For the draws that follow; the whole target until then. Also clips to it.
    void viewport(const Viewport& viewport);

  private:
    friend class Commands;
    using PassBase::PassBase;
    using AnyDraw = std::variant<Draw, DrawIndexed, DrawIndirect>;
    void record(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                std::span<const std::byte> push, const AnyDraw& draw);
};

/// The work of one submission, while it is recorded. One is open at a time.
class Commands {
  public:
    Commands(Commands&& other) noexcept : core_(other.core_), serial_(std::exchange(other.serial_, 0)) {}
    Commands& operator=(Commands&&) = delete;
    /// Submits what was recorded, if Device::submit did not.
    ~Commands();

    /// Opens a pass; at most one is open at a time. The name appears in timings, traces and debuggers.
    Pass pass(std::string_view name);
    RasterPass raster_pass(std::string_view name, const RasterTargets& targets);

    /// Uniform data that lives for this submission alone.
    template <class T>
    requires std::is_trivially_copyable_v<T> UniformBuffer uniform(const T& value) {
        return uniform_bytes(std::as_bytes(std::span(&value, 1)));
    }
    UniformBuffer uniform_bytes(std::span<const std::byte> bytes);

    /// Shows mip 0 of a 2D colour texture in the device's window once the submission is done; once a
    /// submission, as a pass named "present". Row 0 is at the bottom; the texture is stretched where its size
    /// is not the window's. Its texels are taken as a PNG file's: encoded for display, as they are stored.
    /// `vsync`: the device waits for the screen, and frames are shown whole. Nothing happens while the window
    /// is minimised.
    void present(const Texture& texture, bool vsync = true);

    /// The submission's work starts when `sync` is signalled; before its first pass. On the adopted device of a
    /// host alone (rhi/native.hpp). A submission that fails waits for nothing and signals nothing.
    void wait(const NativeSync& sync);
    /// Signals a semaphore when the submission's work is done. Not on OpenGL, where a fence is made by the call
    /// that signals it: there the host puts its own behind Device::submit.
    void signal(const NativeSync& sync);

  private:
    friend class Device;
    Commands(DeviceCore* core, uint64_t serial) : core_(core), serial_(serial) {}
    DeviceCore* core_;
    uint64_t serial_;  ///< 0 once submitted
};

/// One GPU through one API. Make it with backends::create_device.
class Device {
  public:
    Device(std::unique_ptr<Backend> backend, const DeviceDesc& desc);
    Device(Device&&) noexcept;
    Device& operator=(Device&&) noexcept;
    ~Device();

    const DeviceInfo& info() const;
    FormatCaps format_caps(Format format) const;

    /// Errors: out_of_memory, unsupported (format or size), invalid_argument.
    Result<Buffer> create_buffer(const BufferDesc& desc);
    Result<Texture> create_texture(const TextureDesc& desc);
    Result<Sampler> create_sampler(const SamplerDesc& desc);
    /// A host's texture under lumo's name; it takes no memory, and its owner destroys nothing of the host's. On
    /// the adopted device of a host alone (rhi/native.hpp). Errors: invalid_argument, unsupported.
    Result<Texture> adopt_texture(const TextureDesc& desc, const NativeTexture& native);
    /// Likewise a buffer, in Memory::device: lumo maps nothing of the host's.
    Result<Buffer> adopt_buffer(const BufferDesc& desc, const NativeBuffer& native);
    /// Errors: shader, unsupported, out_of_memory.
    template <Program P>
    Result<ComputePipeline<P>> create_compute_pipeline(const typename P::Options& options = {}) {
        return create_pipeline(P::info(), option_values(options), nullptr).map([this](PipelineHandle handle) {
            return ComputePipeline<P>(*core_, handle);
        });
    }
    template <Program P>
    Result<RasterPipeline<P>> create_raster_pipeline(const RasterState& state,
                                                     const typename P::Options& options = {}) {
        return create_pipeline(P::info(), option_values(options), &state).map([this](PipelineHandle handle) {
            return RasterPipeline<P>(*core_, handle);
        });
    }

    /// Starts recording; waits while max_in_flight submissions are unfinished.
    Commands begin();
    Submission submit(Commands&& commands);
    /// Waits for a submission. Errors: device_lost; out_of_memory where the environment refused it a command, or
    /// all of it, known until 16 later ones were begun.
    Result<void> wait(Submission submission);
    bool finished(Submission submission);
    /// Waits for the bytes of a readback and hands them over, once.
    Result<std::vector<std::byte>> take(Readback readback);

    /// Records, submits and waits: for loading and tests, not for frames.
    Result<void> upload(BufferSlice destination, std::span<const std::byte> bytes);
    Result<void> upload(const Texture& destination, const TextureRegion& region,
                        std::span<const std::byte> texels);
    Result<std::vector<std::byte>> download(BufferSlice source);
    Result<std::vector<std::byte>> download(const Texture& source, const TextureRegion& region);

    /// Waits, then the passes of a submission in order. Kept until 16 later submissions were begun.
    std::vector<PassTime> pass_times(Submission submission);
    /// The scopes and barriers of a submission as text (plan.hpp), the same on every API. Kept likewise, and
    /// only while tracing is on.
    std::string trace(Submission submission) const;
    void set_tracing(bool on);

    /// Live resources and their device memory, largest first.
    std::vector<MemoryEntry> memory() const;
    MemoryBudget memory_budget() const;

    /// Sends a message through the device's sink.
    void report(const Message& message) const;

  private:
    static std::span<const uint32_t> option_values(const NoOptions&) { return {}; }
    template <class Options>
    static auto option_values(const Options& options) {
        return options.values();
    }
    Result<PipelineHandle> create_pipeline(const ProgramInfo& program, std::span<const uint32_t> options,
                                           const RasterState* state);

    /// Ends the device's work; the core itself lives on while owners that should be gone still name it.
    struct Close {
        void operator()(DeviceCore* core) const;
    };
    std::unique_ptr<DeviceCore, Close> core_;
};

/// One whole mip, all layers.
TextureRegion whole_mip(const TextureDesc& desc, uint32_t mip = 0);
/// Bytes of a region's texels, tightly packed.
uint64_t region_bytes(Format format, const TextureRegion& region);

}  // namespace lumo::rhi

// Left out, and why: vertex attributes (vertices are pulled from storage buffers: one way to feed rasterizer
// and compute alike); descriptor sets, bindless arrays (software drivers lack run-time indexed samplers);
// subpasses, secondary command buffers, several queues (the one queue of a software driver is the case that
// must be fast); stencil, queries other than time, tessellation and mesh stages (nothing uses them).
