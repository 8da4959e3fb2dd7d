// What a program's bindings are filled with: small values that name resources without owning them.
#pragma once

#include <cstdint>

#include "rhi/program.hpp"

namespace lumo::rhi {

/// Names a resource of one device. A handle outlives its resource harmlessly: using it then is
/// Check::stale_handle.
template <class Tag>
struct Handle {
    uint32_t index = 0;
    uint32_t generation = 0;  ///< 0 names nothing

    explicit operator bool() const { return generation != 0; }
    bool operator==(const Handle&) const = default;
};

using BufferHandle = Handle<struct BufferTag>;
using TextureHandle = Handle<struct TextureTag>;
using SamplerHandle = Handle<struct SamplerTag>;
using PipelineHandle = Handle<struct PipelineTag>;

/// A range of bytes of a buffer.
struct BufferSlice {
    BufferHandle buffer;
    uint64_t offset = 0;
    uint64_t size = 0;

    bool operator==(const BufferSlice&) const = default;
};

/// Part of a texture, seen in some shape and format.
struct TextureView {
    TextureHandle texture;
    Dimension dimension = Dimension::d2;
    Format format = Format::undefined;
    uint32_t first_mip = 0;
    uint32_t mips = 1;
    uint32_t first_layer = 0;
    uint32_t layers = 1;  ///< 6 for a cube

    bool operator==(const TextureView&) const = default;
};

/// A view whose shape the compiler knows, so that a 3D texture does not bind where a 2D one is read.
template <Dimension D>
struct View : TextureView {};

/// A texture read through a sampler. Not default-constructible: a binding that is left out does not compile.
template <Dimension D, TexelKind K = TexelKind::floating>
struct Sampled {
    TextureView view;
    SamplerHandle sampler;

    constexpr Sampled(View<D> v, SamplerHandle s) : view(v), sampler(s) {}
};

/// One mip of a texture, read or written texel by texel. The view's format may be another of the same size,
/// such as r32_uint for rgba8_unorm, where the texture declares it.
template <Dimension D, TexelKind K = TexelKind::floating>
struct StorageImage {
    TextureView view;

    constexpr StorageImage(View<D> v) : view(v) {}
};

struct StorageBuffer {
    BufferSlice slice;

    constexpr StorageBuffer(BufferSlice s) : slice(s) {}
};

struct UniformBuffer {
    BufferSlice slice;

    constexpr UniformBuffer(BufferSlice s) : slice(s) {}
};

/// A binding without its static type, in the order of ProgramInfo::bindings.
struct BindingValue {
    BindingKind kind;
    TextureView view;
    SamplerHandle sampler;
    BufferSlice slice;

    template <Dimension D, TexelKind K>
    constexpr BindingValue(const Sampled<D, K>& s)
        : kind(BindingKind::sampled), view(s.view), sampler(s.sampler) {}
    template <Dimension D, TexelKind K>
    constexpr BindingValue(const StorageImage<D, K>& s) : kind(BindingKind::storage_image), view(s.view) {}
    constexpr BindingValue(const StorageBuffer& s) : kind(BindingKind::storage_buffer), slice(s.slice) {}
    constexpr BindingValue(const UniformBuffer& s) : kind(BindingKind::uniform_buffer), slice(s.slice) {}

    bool operator==(const BindingValue& other) const {
        if (kind != other.kind) return false;
        if (kind == BindingKind::storage_buffer || kind == BindingKind::uniform_buffer)
            return slice == other.slice;
        return view == other.view && sampler == other.sampler;
    }
};

}  // namespace lumo::rhi
