// What resources are made of, and the owners that keep them alive.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rhi/bindings.hpp"

namespace lumo::rhi {

/// Texels; height and depth are 1 where the dimension has none.
struct Extent {
    uint32_t width = 1;
    uint32_t height = 1;
    uint32_t depth = 1;

    bool operator==(const Extent&) const = default;
};

/// Extent of a mip level: halved per level, rounded down, at least 1.
constexpr Extent mip_extent(Extent extent, uint32_t mip) {
    auto half = [mip](uint32_t side) { return side >> mip ? side >> mip : 1; };
    return {half(extent.width), half(extent.height), half(extent.depth)};
}

/// Levels of a full chain down to 1x1x1.
constexpr uint32_t full_mips(Extent extent) {
    uint32_t side = extent.width > extent.height ? extent.width : extent.height;
    side = side > extent.depth ? side : extent.depth;
    uint32_t mips = 1;
    while (side >>= 1) ++mips;
    return mips;
}

enum class BufferUsage : uint8_t { none = 0, storage = 1, uniform = 2, index = 4, indirect = 8 };
template <>
inline constexpr bool is_flags<BufferUsage> = true;

/// Where a buffer lives. `upload` and `readback` are mapped for the host, which writes before the submission
/// that reads, and reads after waiting for the one that writes. Every buffer can be copied from and to.
enum class Memory : uint8_t { device, upload, readback };

struct BufferDesc {
    std::string name = {};
    uint64_t size = 0;  ///< bytes, at least 1
    BufferUsage usage = BufferUsage::storage;
    Memory memory = Memory::device;
};

/// Every texture can be copied from and to.
enum class TextureUsage : uint8_t { none = 0, sampled = 1, storage = 2, attachment = 4 };
template <>
inline constexpr bool is_flags<TextureUsage> = true;

struct TextureDesc {
    std::string name = {};
    Dimension dimension = Dimension::d2;
    Format format = Format::rgba8_unorm;
    Extent extent = {};
    uint32_t layers = 1;  ///< 6 per cube
    uint32_t mips = 1;
    uint32_t samples = 1;  ///< more than 1 with d2_multisample alone
    TextureUsage usage = TextureUsage::sampled;
    std::vector<Format> view_formats = {};  ///< other formats of the same texel size that views may have
};

enum class FilterMode : uint8_t { nearest, linear };
enum class AddressMode : uint8_t { repeat, mirrored_repeat, clamp_to_edge, clamp_to_border };
enum class BorderColor : uint8_t { transparent_black, opaque_black, opaque_white };

struct SamplerDesc {
    FilterMode magnification = FilterMode::linear;
    FilterMode minification = FilterMode::linear;
    FilterMode mip = FilterMode::nearest;
    AddressMode address_u = AddressMode::clamp_to_edge;
    AddressMode address_v = AddressMode::clamp_to_edge;
    AddressMode address_w = AddressMode::clamp_to_edge;
    BorderColor border = BorderColor::transparent_black;
    float max_anisotropy = 1;  ///< clamped to the device's
    float min_lod = 0;
    float max_lod = 1000;

    bool operator==(const SamplerDesc&) const = default;
};

// -- raster state
// -----------------------------------------------------------------------------------------------

enum class Topology : uint8_t { triangles, triangle_strip, lines, points };
enum class CullMode : uint8_t { none, back, front };
enum class Compare : uint8_t { never, less, equal, less_equal, greater, not_equal, greater_equal, always };
enum class BlendFactor : uint8_t {
    zero,
    one,
    source_alpha,
    one_minus_source_alpha,
    destination_alpha,
    one_minus_destination_alpha,
    source_color,
    destination_color
};
enum class BlendOp : uint8_t { add, subtract, minimum, maximum };

struct BlendState {
    BlendFactor source_color = BlendFactor::one;
    BlendFactor destination_color = BlendFactor::zero;
    BlendOp color_op = BlendOp::add;
    BlendFactor source_alpha = BlendFactor::one;
    BlendFactor destination_alpha = BlendFactor::zero;
    BlendOp alpha_op = BlendOp::add;

    bool operator==(const BlendState&) const = default;
};

struct ColorTargetState {
    Format format = Format::undefined;
    std::optional<BlendState> blend = {};
    uint8_t write_mask = 0xf;  ///< bit 0 is red

    bool operator==(const ColorTargetState&) const = default;
};

struct DepthState {
    Format format = Format::d32_float;
    bool write = true;
    Compare compare = Compare::less;
    float bias_constant = 0;  ///< as glPolygonOffset's units
    float bias_slope = 0;

    bool operator==(const DepthState&) const = default;
};

/// Front faces are counter-clockwise as seen with +y up in NDC.
struct RasterState {
    std::vector<ColorTargetState> color = {};
    std::optional<DepthState> depth = {};  ///< none: no depth target
    Topology topology = Topology::triangles;
    CullMode cull = CullMode::back;
    uint32_t samples = 1;
    bool depth_clamp = false;

    bool operator==(const RasterState&) const = default;
};

// -- owners
// -----------------------------------------------------------------------------------------------------

class DeviceCore;

namespace detail {
void release(DeviceCore& core, BufferHandle handle);
void release(DeviceCore& core, TextureHandle handle);
void release(DeviceCore& core, SamplerHandle handle);
void release(DeviceCore& core, PipelineHandle handle);
}  // namespace detail

/// Owns one resource and destroys it once no submission uses it. Move-only; an empty owner is valid to
/// destroy and to assign to. The device must outlive it.
template <class HandleType>
class Owner {
  public:
    Owner() = default;
    Owner(DeviceCore& core, HandleType handle) : core_(&core), handle_(handle) {}
    Owner(Owner&& other) noexcept
        : core_(std::exchange(other.core_, nullptr)), handle_(std::exchange(other.handle_, {})) {}
    Owner& operator=(Owner&& other) noexcept {
        std::swap(core_, other.core_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Owner() {
        if (core_) detail::release(*core_, handle_);
    }

    HandleType handle() const { return handle_; }
    operator HandleType() const { return handle_; }
    explicit operator bool() const { return core_ != nullptr; }

  private:
    DeviceCore* core_ = nullptr;
    HandleType handle_;
};

class Buffer : public Owner<BufferHandle> {
  public:
    Buffer() = default;
    Buffer(DeviceCore& core, BufferHandle handle, uint64_t size, std::byte* mapped)
        : Owner(core, handle), size_(size), mapped_(mapped) {}

    uint64_t size() const { return size_; }
    /// The whole buffer.
    BufferSlice slice() const { return {handle(), 0, size_}; }
    BufferSlice slice(uint64_t offset, uint64_t size) const { return {handle(), offset, size}; }
    /// Host memory of an upload or readback buffer, else null.
    std::byte* mapped() const { return mapped_; }

  private:
    uint64_t size_ = 0;
    std::byte* mapped_ = nullptr;
};

/// Which part of a texture a view shows. Counts of 0 mean all that follow.
struct ViewRange {
    uint32_t first_mip = 0;
    uint32_t mips = 0;
    uint32_t first_layer = 0;
    uint32_t layers = 0;
    Format format = Format::undefined;  ///< undefined: the texture's own
};

class Texture : public Owner<TextureHandle> {
  public:
    Texture() = default;
    Texture(DeviceCore& core, TextureHandle handle, TextureDesc desc)
        : Owner(core, handle), desc_(std::move(desc)) {}

    const TextureDesc& desc() const { return desc_; }

    /// A view of shape D. Whether the texture can have it is checked where it is used.
    template <Dimension D>
    View<D> view(ViewRange range = {}) const {
        return View<D>{whole(D, range)};
    }
    /// A view of the texture's own shape.
    TextureView view(ViewRange range = {}) const { return whole(desc_.dimension, range); }
    /// One mip, all layers: what StorageImage and attachments take.
    template <Dimension D>
    View<D> mip(uint32_t level, Format format = Format::undefined) const {
        return view<D>({.first_mip = level, .mips = 1, .format = format});
    }

  private:
    TextureView whole(Dimension dimension, const ViewRange& range) const {
        return {handle(),
                dimension,
                range.format == Format::undefined ? desc_.format : range.format,
                range.first_mip,
                range.mips ? range.mips : desc_.mips - range.first_mip,
                range.first_layer,
                range.layers ? range.layers : desc_.layers - range.first_layer};
    }

    TextureDesc desc_;
};

using Sampler = Owner<SamplerHandle>;

/// Pipelines carry their program's type, so that only its own bindings fit.
template <Program P>
class ComputePipeline : public Owner<PipelineHandle> {
    using Owner::Owner;
};
template <Program P>
class RasterPipeline : public Owner<PipelineHandle> {
    using Owner::Owner;
};

}  // namespace lumo::rhi
