// A compiled shader program as data. The shader compiler writes one ProgramInfo per program, and beside it a
// C++ type with the program's Bindings, Push and Options (see shadercompiler/). Techniques use those types;
// only the core of the RHI and the backends read what is here.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "rhi/flags.hpp"
#include "rhi/format.hpp"

namespace lumo::rhi {

enum class Stages : uint8_t { none = 0, vertex = 1, geometry = 2, fragment = 4, compute = 8 };
template <>
inline constexpr bool is_flags<Stages> = true;

/// The shape of a view as a shader sees it.
enum class Dimension : uint8_t { d1, d2, d3, cube, d1_array, d2_array, cube_array, d2_multisample };

enum class BindingKind : uint8_t { sampled, storage_image, storage_buffer, uniform_buffer };

/// What a shader does to a storage resource. `atomic` means by commutative atomic operations alone.
enum class ShaderAccess : uint8_t { read, write, read_write, atomic };

/// The type of the texels that a sampler or an image returns.
enum class TexelKind : uint8_t { floating, uint, sint };

/// One resource of a program. Binding numbers are GLSL's own (Vulkan: set 0, at most 32).
struct BindingInfo {
    std::string_view name;
    uint32_t binding;
    BindingKind kind;
    Dimension dimension;  ///< sampled and storage_image
    TexelKind texel;      ///< sampled and storage_image
    Format format;        ///< storage_image: as declared in the shader; undefined for a write without format
    ShaderAccess access;
    Stages stages;      ///< those that use it, or where none does those that declare it
    uint32_t gl_slot;   ///< OpenGL's unit of its kind: texture, image, shader storage or uniform block
    uint32_t min_size;  ///< buffers: bytes of the fixed part of the block
};

enum class OptionType : uint8_t { boolean, sint, uint, floating };

/// One specialization constant. Values travel as 32 bits.
struct OptionInfo {
    std::string_view name;
    uint32_t id;
    OptionType type;
    uint32_t default_bits;
};

/// One stage in both languages. The SPIR-V has entry point main. The OpenGL text is GLSL 450 whose
/// specialization constants are macros SPIRV_CROSS_CONSTANT_ID_n, to be defined after its #version line.
struct StageInfo {
    Stages stage;
    std::span<const uint32_t> spirv;
    std::string_view glsl;
};

struct ProgramInfo {
    std::string_view name;  ///< FOLDER/STEM of its sources below shaders/
    std::span<const StageInfo> stages;
    std::span<const BindingInfo> bindings;        ///< by ascending binding number
    std::span<const OptionInfo> options;          ///< by ascending id
    uint32_t push_size = 0;                       ///< bytes, at most max_push_size, 0 without a push block
    std::array<uint32_t, 3> local_size{1, 1, 1};  ///< compute
    uint32_t color_outputs = 0;                   ///< bit i: the fragment stage writes location i
    uint64_t hash = 0;                            ///< of all code in it

    constexpr bool is_compute() const { return !stages.empty() && stages.front().stage == Stages::compute; }
};

inline constexpr uint32_t max_push_size = 128;
inline constexpr uint32_t max_bindings = 32;
inline constexpr uint32_t max_gl_images = 8;
/// OpenGL's uniform block slot that stands for push constants.
inline constexpr uint32_t gl_push_slot = 0;

/// Programs without push constants or options have these.
struct NoPush {};
struct NoOptions {};

/// What the shader compiler generates: a type that names a program and the shape of what it needs.
///   struct P {
///     struct Bindings { …; std::array<BindingValue, N> values() const; };
///     struct Push { … } or using Push = NoPush;
///     struct Options { …; std::array<uint32_t, N> values() const; } or using Options = NoOptions;
///     static const ProgramInfo& info();
///   };
template <class P>
concept Program = requires {
    typename P::Bindings;
    typename P::Push;
    typename P::Options;
    {P::info()};
};

}  // namespace lumo::rhi
