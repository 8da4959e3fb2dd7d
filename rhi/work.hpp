// The arguments of passes and commands.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "rhi/resources.hpp"

namespace lumo::rhi {

/// Work groups of a dispatch.
struct Groups {
    uint32_t x = 1;
    uint32_t y = 1;
    uint32_t z = 1;
    /// No barrier against earlier dispatches whose atomics on the same memory commute with this one's.
    bool unordered = false;
};

/// Groups of `local` that cover `count` items.
constexpr uint32_t groups_for(uint32_t count, uint32_t local) { return (count + local - 1) / local; }
constexpr Groups groups_for(Extent items, Extent local) {
    return {groups_for(items.width, local.width), groups_for(items.height, local.height),
            groups_for(items.depth, local.depth)};
}

enum class IndexType : uint8_t { uint16, uint32 };

struct Draw {
    uint32_t vertices = 0;
    uint32_t instances = 1;
    uint32_t first_vertex = 0;
};

struct DrawIndexed {
    BufferSlice indices = {};
    IndexType type = IndexType::uint32;
    uint32_t count = 0;
    uint32_t instances = 1;
    uint32_t first = 0;         ///< index
    int32_t vertex_offset = 0;  ///< added to each index
};

struct DrawIndirect {
    BufferSlice arguments = {};  ///< per draw: vertices, instances, first vertex, 0; indexed: count,
                                 ///< instances, first, offset, 0
    uint32_t draws = 1;
    BufferSlice indices = {};  ///< empty: not indexed; else at offset 0, from where OpenGL counts
    IndexType type = IndexType::uint32;
};

/// Texels of the targets; depth range [0, 1].
struct Viewport {
    float x = 0;
    float y = 0;  ///< from memory row 0
    float width = 0;
    float height = 0;
};

enum class Load : uint8_t { clear, keep, discard };

using ClearColor = std::variant<std::array<float, 4>, std::array<uint32_t, 4>, std::array<int32_t, 4>>;
/// Colour, or depth as the first float.
using ClearValue = ClearColor;

struct ColorTarget {
    TextureView view = {};  ///< one mip; several layers make a layered target
    Load load = Load::clear;
    ClearColor clear = std::array<float, 4>{};
    std::optional<TextureView> resolve = {};  ///< of one sample, filled with the average at the end
};

struct DepthTarget {
    TextureView view = {};
    Load load = Load::clear;
    float clear = 1;
};

struct RasterTargets {
    std::vector<ColorTarget> color = {};
    std::optional<DepthTarget> depth = {};
    Extent extent = {};    ///< without any target: the raster's size; else taken from them
    uint32_t samples = 1;  ///< likewise
};

/// Texels of one mip; z and depth count slices of a 3D texture.
struct TextureRegion {
    uint32_t mip = 0;
    uint32_t first_layer = 0;
    uint32_t layers = 1;
    uint32_t x = 0, y = 0, z = 0;
    Extent extent = {};
};

}  // namespace lumo::rhi
