// Programs as the shader compiler would write them, without code: what the fake backend takes.
#pragma once

#include "rhi/program.hpp"
#include "rhi/resources.hpp"

namespace lumo::rhi::fake {

inline constexpr StageInfo compute_stage[] = {{Stages::compute, {}, {}}};
inline constexpr StageInfo raster_stages[] = {{Stages::vertex, {}, {}}, {Stages::fragment, {}, {}}};

constexpr BindingInfo buffer_binding(std::string_view name, uint32_t binding, BindingKind kind,
                                     ShaderAccess access, Stages stages, uint32_t min_size = 4) {
    return {name,   binding, kind, Dimension::d2, TexelKind::floating, Format::undefined,
            access, stages,  0,    min_size};
}

/// Writes a buffer; has push constants.
struct Store {
    struct Bindings {
        StorageBuffer target;
        std::array<BindingValue, 1> values() const { return {target}; }
    };
    struct Push {
        uint32_t first;
        uint32_t second;
    };
    using Options = NoOptions;
    static const ProgramInfo& info() {
        static constexpr BindingInfo bindings[] = {buffer_binding("target", 0, BindingKind::storage_buffer,
                                                                  ShaderAccess::write, Stages::compute, 16)};
        static constexpr ProgramInfo program{.name = "fake/store",
                                             .stages = compute_stage,
                                             .bindings = bindings,
                                             .options = {},
                                             .push_size = sizeof(Push)};
        return program;
    }
};

/// Reads one buffer, writes another by atomics alone, with settings in a uniform block.
struct Count {
    struct Bindings {
        StorageBuffer source;
        StorageBuffer counter;
        UniformBuffer settings;
        std::array<BindingValue, 3> values() const { return {source, counter, settings}; }
    };
    using Push = NoPush;
    using Options = NoOptions;
    static const ProgramInfo& info() {
        static constexpr BindingInfo bindings[] = {
            buffer_binding("source", 0, BindingKind::storage_buffer, ShaderAccess::read, Stages::compute),
            buffer_binding("counter", 1, BindingKind::storage_buffer, ShaderAccess::atomic, Stages::compute),
            buffer_binding("settings", 2, BindingKind::uniform_buffer, ShaderAccess::read, Stages::compute,
                           16)};
        static constexpr ProgramInfo program{
            .name = "fake/count", .stages = compute_stage, .bindings = bindings, .options = {}};
        return program;
    }
};

/// Reads a float texture and writes an r32_uint image.
struct Convert {
    struct Bindings {
        Sampled<Dimension::d2> source;
        StorageImage<Dimension::d2, TexelKind::uint> target;
        std::array<BindingValue, 2> values() const { return {source, target}; }
    };
    using Push = NoPush;
    using Options = NoOptions;
    static const ProgramInfo& info() {
        static constexpr BindingInfo bindings[] = {
            {"source", 0, BindingKind::sampled, Dimension::d2, TexelKind::floating, Format::undefined,
             ShaderAccess::read, Stages::compute, 0, 0},
            {"target", 1, BindingKind::storage_image, Dimension::d2, TexelKind::uint, Format::r32_uint,
             ShaderAccess::write, Stages::compute, 0, 0}};
        static constexpr ProgramInfo program{
            .name = "fake/convert", .stages = compute_stage, .bindings = bindings, .options = {}};
        return program;
    }
};

/// Pulls vertices from a buffer, draws one colour, and in fragments stores to one buffer and counts in another.
struct Paint {
    struct Bindings {
        StorageBuffer vertices;
        StorageBuffer list;
        StorageBuffer counter;
        std::array<BindingValue, 3> values() const { return {vertices, list, counter}; }
    };
    using Push = NoPush;
    using Options = NoOptions;
    static const ProgramInfo& info() {
        static constexpr BindingInfo bindings[] = {
            buffer_binding("vertices", 0, BindingKind::storage_buffer, ShaderAccess::read, Stages::vertex),
            buffer_binding("list", 1, BindingKind::storage_buffer, ShaderAccess::write, Stages::fragment),
            buffer_binding("counter", 2, BindingKind::storage_buffer, ShaderAccess::atomic,
                           Stages::fragment)};
        static constexpr ProgramInfo program{.name = "fake/paint",
                                             .stages = raster_stages,
                                             .bindings = bindings,
                                             .options = {},
                                             .color_outputs = 1};
        return program;
    }
};

}  // namespace lumo::rhi::fake
