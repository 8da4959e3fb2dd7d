// What an API must provide so that the RHI runs on it. Backends do as they are told: all handles are valid,
// all arguments were checked, all barriers are spelled out. Only the core of the RHI calls this.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rhi/check.hpp"
#include "rhi/device_info.hpp"
#include "rhi/error.hpp"
#include "rhi/native.hpp"
#include "rhi/plan.hpp"
#include "rhi/resources.hpp"
#include "rhi/work.hpp"

namespace lumo::rhi {

// Commands as the core hands them on. Byte ranges of push constants point into the pass's own storage.

/// Commands of one pass that bind the same to the same pipeline may share the memory of `bindings`; others do not.
struct PipelineBindings {
    PipelineHandle pipeline;
    std::span<const BindingValue> bindings;  ///< in the order of ProgramInfo::bindings
    std::span<const std::byte> push;
};

struct DispatchCommand {
    PipelineBindings what;
    uint32_t x, y, z;
};
struct DispatchIndirectCommand {
    PipelineBindings what;
    BufferSlice arguments;  ///< three uint32: groups
};
struct DrawCommand {
    PipelineBindings what;
    uint32_t vertices, instances, first_vertex;
};
struct DrawIndexedCommand {
    PipelineBindings what;
    BufferSlice indices;
    IndexType index_type;
    uint32_t count, instances, first_index;
    int32_t vertex_offset;
};
struct DrawIndirectCommand {
    PipelineBindings what;
    BufferSlice arguments;  ///< VkDrawIndirectCommand, or VkDrawIndexedIndirectCommand with indices
    uint32_t draws;
    uint32_t stride;      ///< bytes
    BufferSlice indices;  ///< empty: not indexed
    IndexType index_type;
};
struct ViewportCommand {
    Viewport viewport;
};
struct CopyBufferCommand {
    BufferSlice source;
    BufferSlice destination;
};
struct CopyTextureCommand {
    TextureHandle source, destination;
    TextureRegion source_region;
    TextureRegion destination_region;  ///< extent equals the source's
};
/// Texels in the buffer are tightly packed, row 0 first, then slices or layers.
struct CopyBufferToTextureCommand {
    BufferSlice source;
    TextureHandle destination;
    TextureRegion region;
};
struct CopyTextureToBufferCommand {
    TextureHandle source;
    TextureRegion region;
    BufferSlice destination;
};
struct FillBufferCommand {
    BufferSlice destination;
    uint32_t value;
};
struct ClearTextureCommand {
    TextureView view;
    ClearValue value;
};
/// Halves `source_mip` into the next mip with a linear filter, all layers.
struct BlitMipCommand {
    TextureHandle texture;
    uint32_t source_mip;
};

/// In the window, once the submission is done: mip 0 of a 2D texture, stretched to the window's size, row 0 at
/// the bottom, texels as they are stored. Once a submission.
struct PresentCommand {
    TextureHandle texture;
    bool vsync;
};

using Command = std::variant<DispatchCommand, DispatchIndirectCommand, DrawCommand, DrawIndexedCommand,
                             DrawIndirectCommand, ViewportCommand, CopyBufferCommand, CopyTextureCommand,
                             CopyBufferToTextureCommand, CopyTextureToBufferCommand, FillBufferCommand,
                             ClearTextureCommand, BlitMipCommand, PresentCommand>;

struct Step {
    std::span<const Barrier> barriers;  ///< in front of the command; empty inside raster passes
    Command command;
};

/// A finished pass. With targets it is a raster pass: `barriers` come before it begins and its steps hold
/// draws and viewports alone.
struct EmittedPass {
    std::string_view name;
    const RasterTargets* targets = nullptr;
    std::vector<Barrier> barriers;
    std::span<const Step> steps;
};

/// Nanoseconds on the device's own clock.
struct PassStamp {
    uint64_t begin_ns = 0;
    uint64_t end_ns = 0;
};

struct CreatedBuffer {
    std::byte* mapped = nullptr;  ///< host-visible memory: coherent, mapped for the buffer's whole life
    uint64_t allocated_bytes = 0;
};

/// The answer of a device of lumo's own to a resource or a semaphore of a host's.
inline tl::unexpected<Error> not_adopted(std::string subject) {
    return fail(ErrorKind::unsupported, std::move(subject), "the device was not made from a host's",
                "adopt the host's device, as docs/porting.md shows");
}

/// Resources are named by the core's handles; their index is small and dense, and a backend keeps its own
/// objects by it. Calls come from one thread. A call that failed leaves nothing behind. After the error
/// device_lost nothing runs on the device any more, and only destructions follow.
class Backend {
  public:
    virtual ~Backend() = default;

    virtual const DeviceInfo& info() const = 0;
    virtual FormatCaps format_caps(Format format) const = 0;

    virtual Result<CreatedBuffer> create_buffer(BufferHandle handle, const BufferDesc& desc) = 0;
    /// Returns the bytes taken from the device.
    virtual Result<uint64_t> create_texture(TextureHandle handle, const TextureDesc& desc) = 0;
    /// A host's texture, which `destroy` leaves alone. Errors: invalid_argument (what cannot be such a texture),
    /// unsupported (the device is not a host's, or lacks the format, size or use).
    virtual Result<void> adopt_texture(TextureHandle handle, const TextureDesc& desc,
                                       const NativeTexture& native) = 0;
    virtual Result<void> adopt_buffer(BufferHandle handle, const BufferDesc& desc,
                                      const NativeBuffer& native) = 0;
    virtual Result<void> create_sampler(SamplerHandle handle, const SamplerDesc& desc) = 0;
    /// `options` are 32-bit values in the order of ProgramInfo::options. `raster` is null for compute.
    virtual Result<void> create_pipeline(PipelineHandle handle, const ProgramInfo& program,
                                         std::span<const uint32_t> options, const RasterState* raster) = 0;
    /// Only when the device no longer uses them.
    virtual void destroy(BufferHandle handle) = 0;
    virtual void destroy(TextureHandle handle) = 0;
    virtual void destroy(SamplerHandle handle) = 0;
    virtual void destroy(PipelineHandle handle) = 0;

    /// Opens submission `serial` (1, 2, 3, …). Passes are emitted into it until submit. When more submissions
    /// are in flight than `max_in_flight`, waits for the oldest. After an error the submission counts as finished
    /// with those before it, and neither emit nor submit follow.
    virtual Result<void> begin(uint64_t serial) = 0;
    /// Records a pass, with a label, and time stamps around it. Host reads of copied data are ordered by
    /// `submit`. After an error the barriers stand, and the commands that it concerns are left out.
    virtual Result<void> emit(const EmittedPass& pass) = 0;
    /// `hand_back`: barriers after the last pass, of the host's textures that the submission used. Their accesses
    /// and layouts by the host are `external`; so are those of barriers in front of a submission's first use.
    /// After an error nothing of the submission runs, and it counts as finished with those before it.
    virtual Result<void> submit(std::span<const Barrier> hand_back) = 0;
    /// Of the open submission: its work waits for, or signals, what is the host's. `wait_for` comes before its
    /// first pass. Error: unsupported.
    virtual Result<void> wait_for(const NativeSync& sync) = 0;
    virtual Result<void> signal(const NativeSync& sync) = 0;
    /// The last serial that the device has finished.
    virtual uint64_t completed() = 0;
    virtual Result<void> wait(uint64_t serial) = 0;
    /// One stamp per emitted pass, in order, of a finished submission; kept until 16 later ones were begun.
    virtual std::vector<PassStamp> stamps(uint64_t serial) = 0;

    /// Bytes that the driver says are in use and may be used, or zeros.
    virtual MemoryBudget memory_budget() = 0;
};

/// Submissions that may be in flight at once.
inline constexpr uint32_t max_in_flight = 2;

}  // namespace lumo::rhi
