#include "shadercompiler/reflect.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glslang/SPIRV/doc.h>
#include <map>
#include <optional>
#include <spirv_cross/spirv_cross.hpp>

#include "shadercompiler/spirv_uses.hpp"

namespace lumo::shadercompiler {
namespace {

using rhi::BindingKind;
using rhi::Dimension;
using rhi::Format;
using rhi::ShaderAccess;
using rhi::Stages;
using rhi::TexelKind;
using spirv_cross::Resource;
using spirv_cross::SPIRType;

/// What OpenGL 4.5 core and Vulkan 1.3 on the target drivers both have.
constexpr std::array allowed_capabilities = {
    spv::CapabilityMatrix,
    spv::CapabilityShader,
    spv::CapabilityGeometry,
    spv::CapabilityGeometryPointSize,
    spv::CapabilityImageGatherExtended,
    spv::CapabilityClipDistance,
    spv::CapabilityCullDistance,
    spv::CapabilityImageCubeArray,
    spv::CapabilitySampleRateShading,
    spv::CapabilitySampled1D,
    spv::CapabilityImage1D,
    spv::CapabilitySampledCubeArray,
    spv::CapabilityStorageImageExtendedFormats,
    spv::CapabilityImageQuery,
    spv::CapabilityDerivativeControl,
    spv::CapabilityInterpolationFunction,
    spv::CapabilityStorageImageWriteWithoutFormat,
    spv::CapabilityMultiViewport,
};

std::optional<Format> format_of(spv::ImageFormat format) {
    switch (format) {
        case spv::ImageFormatUnknown:
            return Format::undefined;
        case spv::ImageFormatR8:
            return Format::r8_unorm;
        case spv::ImageFormatRg8:
            return Format::rg8_unorm;
        case spv::ImageFormatRgba8:
            return Format::rgba8_unorm;
        case spv::ImageFormatRgba8ui:
            return Format::rgba8_uint;
        case spv::ImageFormatRgb10A2:
            return Format::rgb10a2_unorm;
        case spv::ImageFormatR11fG11fB10f:
            return Format::r11g11b10_float;
        case spv::ImageFormatR16ui:
            return Format::r16_uint;
        case spv::ImageFormatR16f:
            return Format::r16_float;
        case spv::ImageFormatRg16f:
            return Format::rg16_float;
        case spv::ImageFormatRgba16f:
            return Format::rgba16_float;
        case spv::ImageFormatRgba16:
            return Format::rgba16_unorm;
        case spv::ImageFormatR32ui:
            return Format::r32_uint;
        case spv::ImageFormatR32i:
            return Format::r32_sint;
        case spv::ImageFormatR32f:
            return Format::r32_float;
        case spv::ImageFormatRg32ui:
            return Format::rg32_uint;
        case spv::ImageFormatRg32f:
            return Format::rg32_float;
        case spv::ImageFormatRgba32ui:
            return Format::rgba32_uint;
        case spv::ImageFormatRgba32f:
            return Format::rgba32_float;
        default:
            return std::nullopt;
    }
}

std::optional<Dimension> dimension_of(const SPIRType::ImageType& image) {
    if (image.ms) {
        return image.dim == spv::Dim2D && !image.arrayed ? std::optional(Dimension::d2_multisample)
                                                         : std::nullopt;
    }
    switch (image.dim) {
        case spv::Dim1D:
            return image.arrayed ? Dimension::d1_array : Dimension::d1;
        case spv::Dim2D:
            return image.arrayed ? Dimension::d2_array : Dimension::d2;
        case spv::Dim3D:
            return Dimension::d3;
        case spv::DimCube:
            return image.arrayed ? Dimension::cube_array : Dimension::cube;
        default:
            return std::nullopt;
    }
}

std::optional<TexelKind> texel_of(SPIRType::BaseType type) {
    switch (type) {
        case SPIRType::Float:
            return TexelKind::floating;
        case SPIRType::UInt:
            return TexelKind::uint;
        case SPIRType::Int:
            return TexelKind::sint;
        default:
            return std::nullopt;
    }
}

bool has_word(std::string_view line, std::string_view word) {
    const auto in_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    for (size_t at = line.find(word); at != std::string_view::npos; at = line.find(word, at + 1)) {
        const size_t end = at + word.size();
        if ((at == 0 || !in_word(line[at - 1])) && (end == line.size() || !in_word(line[end]))) return true;
    }
    return false;
}

/// The number of the first line that has the name beside a word that declares.
std::optional<int> declaring_line(std::string_view text, std::string_view name) {
    for (int number = 1; !text.empty(); ++number) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, std::min(end, text.find("//")));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (!name.empty() && has_word(line, name) &&
            (has_word(line, "uniform") || has_word(line, "buffer") || has_word(line, "constant_id") ||
             has_word(line, "in"))) {
            return number;
        }
    }
    return std::nullopt;
}

/// What one stage declares under one binding number.
struct Declaration {
    std::string name;
    std::string block_name;  // of buffers
    std::string where;       // for messages
    BindingKind kind{};
    Dimension dimension{};
    TexelKind texel{};
    Format format{};
    uint32_t min_size = 0;
    Block block;  // of uniform buffers
    bool readonly = false;
    bool writeonly = false;
    bool read_write = false;  // by the macro
    Uses uses;
    Stages stages{};    // that use it
    Stages declared{};  // that declare it

    bool same_resource(const Declaration& o) const {
        return name == o.name && block_name == o.block_name && kind == o.kind && dimension == o.dimension &&
               texel == o.texel && format == o.format && min_size == o.min_size && readonly == o.readonly &&
               writeonly == o.writeonly && read_write == o.read_write;
    }
};

struct Option {
    std::string name;
    rhi::OptionType type{};
    uint32_t default_bits = 0;

    bool operator==(const Option&) const = default;
};

/// Gathers the stages of one program, and every rule that they break.
class Reflector {
  public:
    Reflector(const ProgramSource& source, const std::vector<IncludedFile>& includes)
        : source_(source), includes_(includes) {}

    void add_stage(const StageSource& stage, const Words& spirv) {
        stage_ = &stage;
        const ModuleUses uses = find_uses(spirv);
        check_module(uses);

        const spirv_cross::Compiler compiler(spirv);
        const spirv_cross::ShaderResources resources = compiler.get_shader_resources();
        const auto active = compiler.get_active_interface_variables();
        const auto add_all = [&](const auto& list, BindingKind kind) {
            for (const Resource& resource : list) {
                Declaration declaration;
                declaration.kind = kind;
                if (const auto it = uses.of_variable.find(resource.id); it != uses.of_variable.end()) {
                    declaration.uses = it->second;
                }
                declaration.declared = stage.stage;
                if (active.contains(resource.id)) declaration.stages = stage.stage;
                add_binding(compiler, resource, std::move(declaration));
            }
        };
        add_all(resources.sampled_images, BindingKind::sampled);
        add_all(resources.storage_images, BindingKind::storage_image);
        add_all(resources.storage_buffers, BindingKind::storage_buffer);
        add_all(resources.uniform_buffers, BindingKind::uniform_buffer);
        for (const Resource& r : resources.separate_images)
            fault_at(declaration_of(r.name), "'{}': textures need a combined sampler", r.name);
        for (const Resource& r : resources.separate_samplers)
            fault_at(declaration_of(r.name), "'{}': samplers need to be combined", r.name);
        for (const Resource& r : resources.subpass_inputs) fault("'{}': there are no subpass inputs", r.name);

        for (const Resource& resource : resources.push_constant_buffers) add_push(compiler, resource);
        add_options(compiler);
        if (stage.stage == Stages::vertex) {
            for (const Resource& r : resources.stage_inputs) {
                fault_at(declaration_of(r.name),
                         "'{}': there are no vertex attributes; read a storage buffer at gl_VertexIndex",
                         r.name);
            }
        }
        if (stage.stage == Stages::fragment) {
            for (const Resource& r : resources.stage_outputs) {
                reflection_.color_outputs |= 1u << compiler.get_decoration(r.id, spv::DecorationLocation);
            }
        }
        if (stage.stage == Stages::compute) add_local_size(compiler);
    }

    Result<Reflection> finish() {
        stage_ = nullptr;
        uint32_t slots[4] = {};
        slots[size_t(BindingKind::uniform_buffer)] = rhi::gl_push_slot + 1;
        std::map<std::string, uint32_t> names;
        std::map<std::string, uint32_t> block_names;
        for (const auto& [binding, declaration] : declarations_) {
            const auto claim = [&, number = binding](auto& taken, const std::string& name) {
                const auto [it, fresh] = taken.emplace(name, number);
                if (!fresh)
                    fault_at(declaration.where, "'{}' names both binding {} and binding {}", name, it->second,
                             number);
            };
            claim(names, declaration.name);
            if (!declaration.block_name.empty()) claim(block_names, declaration.block_name);
            if (!reflection_.push.members.empty() && declaration.block_name == reflection_.push.name) {
                fault_at(declaration.where, "'{}' names a block and the push constants",
                         declaration.block_name);
            }
            reflection_.bindings.push_back({
                .name = {},
                .binding = binding,
                .kind = declaration.kind,
                .dimension = declaration.dimension,
                .texel = declaration.texel,
                .format = declaration.format,
                .access = access_of(declaration),
                .stages = declaration.stages == Stages::none ? declaration.declared : declaration.stages,
                .gl_slot = slots[size_t(declaration.kind)]++,
                .min_size = declaration.min_size,
            });
            reflection_.binding_names.push_back(declaration.name);
            if (declaration.kind == BindingKind::uniform_buffer) {
                reflection_.uniform_blocks.push_back(declaration.block);
            }
        }
        if (const uint32_t images = slots[size_t(BindingKind::storage_image)]; images > rhi::max_gl_images) {
            fault("{} storage images; at most {} work on OpenGL", images, rhi::max_gl_images);
        }
        for (const auto& [id, option] : options_) {
            reflection_.options.push_back(
                {.name = {}, .id = id, .type = option.type, .default_bits = option.default_bits});
            reflection_.option_names.push_back(option.name);
        }
        if (!faults_.empty()) {
            return fail(ErrorKind::shader, source_.name, fmt::format("\n{}", fmt::join(faults_, "\n")));
        }
        return std::move(reflection_);
    }

  private:
    /// "path:line" of the line that declares `name`, as far as a look at the text can tell: the path
    /// otherwise.
    std::string declaration_of(std::string_view name) const {
        if (!stage_) return source_.name;
        if (const auto line = declaring_line(stage_->text, name)) {
            return fmt::format("{}:{}", stage_->path.string(), *line);
        }
        for (const IncludedFile& include : includes_) {
            if (const auto line = declaring_line(include.text, name)) {
                return fmt::format("{}:{}", include.path.string(), *line);
            }
        }
        return stage_->path.string();
    }

    template <class... Args>
    void fault_at(const std::string& where, fmt::format_string<Args...> format, Args&&... args) {
        faults_.push_back(where + ": error: " + fmt::format(format, std::forward<Args>(args)...));
    }

    /// About the stage that is being added, or about the program.
    template <class... Args>
    void fault(fmt::format_string<Args...> format, Args&&... args) {
        fault_at(stage_ ? stage_->path.string() : source_.name, format, std::forward<Args>(args)...);
    }

    void check_module(const ModuleUses& uses) {
        for (const uint32_t capability : uses.capabilities) {
            if (std::ranges::find(allowed_capabilities, spv::Capability(capability)) ==
                allowed_capabilities.end()) {
                fault("needs {}, which OpenGL 4.5 or the Vulkan drivers in use lack",
                      spv::CapabilityString(int(capability)));
            }
        }
        if (uses.is_volatile) fault("volatile is lost in the OpenGL text; use coherent, or atomics");
    }

    void add_binding(const spirv_cross::Compiler& compiler, const Resource& resource,
                     Declaration declaration) {
        const SPIRType& type = compiler.get_type(resource.type_id);
        const bool is_image =
            declaration.kind == BindingKind::sampled || declaration.kind == BindingKind::storage_image;
        declaration.name = compiler.get_name(resource.id);
        if (!is_image) {
            declaration.block_name = compiler.get_name(resource.base_type_id);
            if (declaration.name.empty()) declaration.name = declaration.block_name;
        }
        const std::string& name = declaration.name;
        declaration.where = declaration_of(is_image ? name : declaration.block_name);
        if (!type.array.empty())
            return fault_at(declaration.where, "'{}': there are no arrays of samplers, images or blocks",
                            name);
        if (compiler.get_decoration(resource.id, spv::DecorationDescriptorSet) != 0) {
            return fault_at(declaration.where, "'{}': there is only set 0", name);
        }
        if (!compiler.has_decoration(resource.id, spv::DecorationBinding)) {
            return fault_at(declaration.where, "'{}': write layout(binding = N)", name);
        }
        const uint32_t binding = compiler.get_decoration(resource.id, spv::DecorationBinding);
        if (binding >= rhi::max_bindings) {
            return fault_at(declaration.where, "'{}': binding {} is not below {}", name, binding,
                            rhi::max_bindings);
        }

        spirv_cross::Bitset qualifiers = compiler.get_decoration_bitset(resource.id);
        if (declaration.kind == BindingKind::storage_buffer) {
            qualifiers = compiler.get_buffer_block_flags(resource.id);
        }
        declaration.readonly = qualifiers.get(spv::DecorationNonWritable);
        declaration.writeonly = qualifiers.get(spv::DecorationNonReadable);
        declaration.read_write = qualifiers.get(spv::DecorationRestrict);

        if (is_image) {
            const auto dimension = dimension_of(type.image);
            const auto texel = texel_of(compiler.get_type(type.image.type).basetype);
            if (!dimension || !texel)
                return fault_at(declaration.where, "'{}': there are no views of this type", name);
            declaration.dimension = *dimension;
            declaration.texel = *texel;
        }
        if (declaration.kind == BindingKind::storage_image) {
            const auto format = format_of(type.image.format);
            if (!format)
                return fault_at(declaration.where, "'{}': this image format is not among rhi::Format", name);
            declaration.format = *format;
            if (*format == Format::undefined && !declaration.writeonly) {
                return fault_at(declaration.where, "'{}': declare the image's format, or make it writeonly",
                                name);
            }
            if (declaration.dimension == Dimension::d2_multisample) {
                return fault_at(declaration.where, "'{}': there are no multisampled storage images", name);
            }
        } else if (!is_image) {
            declaration.min_size = uint32_t(compiler.get_declared_struct_size(type));
        }
        if (declaration.kind == BindingKind::uniform_buffer) {
            declaration.block = block_of(compiler, type, declaration.block_name);
            declaration.min_size = declaration.block.size;
            if (const std::string member = first_member_off_std140(declaration.block); !member.empty()) {
                return fault_at(declaration.where, "'{}': member {} is not where std140 puts it", name,
                                member);
            }
        }
        merge(binding, std::move(declaration));
    }

    void merge(uint32_t binding, Declaration declaration) {
        const auto [it, fresh] = declarations_.try_emplace(binding, declaration);
        if (fresh) return;
        Declaration& known = it->second;
        if (!known.same_resource(declaration)) {
            return fault_at(declaration.where,
                            "binding {}: '{}' here and '{}' elsewhere are not declared alike", binding,
                            declaration.name, known.name);
        }
        known.stages |= declaration.stages;
        known.declared |= declaration.declared;
        known.uses.atomic |= declaration.uses.atomic;
        known.uses.plain |= declaration.uses.plain;
    }

    /// DESIGN's rule for barriers: what a pass does to a resource is what the shader says it does.
    ShaderAccess access_of(const Declaration& d) {
        if (d.kind == BindingKind::sampled || d.kind == BindingKind::uniform_buffer || d.readonly) {
            return ShaderAccess::read;
        }
        if (d.writeonly) return ShaderAccess::write;
        if (d.read_write) return ShaderAccess::read_write;
        if (!d.uses.atomic || d.uses.plain) {
            fault_at(
                d.where,
                "'{}': declare it readonly, writeonly or LUMO_READ_WRITE (without them, only commutative "
                "atomics "
                "may use it)",
                d.name);
        }
        return ShaderAccess::atomic;
    }

    Block block_of(const spirv_cross::Compiler& compiler, const SPIRType& type, std::string name) {
        Block block;
        block.name = std::move(name);
        std::map<std::string, int> structs;
        block.members = members_of(compiler, type, block, structs);
        block.size = uint32_t((compiler.get_declared_struct_size(type) + 15) / 16 * 16);
        return block;
    }

    std::vector<BlockMember> members_of(const spirv_cross::Compiler& compiler, const SPIRType& type,
                                        Block& block, std::map<std::string, int>& structs) {
        std::vector<BlockMember> members;
        for (uint32_t i = 0; i < type.member_types.size(); ++i) {
            const SPIRType& member_type = compiler.get_type(type.member_types[i]);
            BlockMember member;
            member.name = compiler.get_member_name(type.self, i);
            member.offset = compiler.type_struct_member_offset(type, i);
            member.rows = member_type.vecsize;
            member.columns = member_type.columns;
            if (member_type.columns > 1) {
                member.row_major = compiler.has_member_decoration(type.self, i, spv::DecorationRowMajor);
                member.matrix_stride = compiler.type_struct_member_matrix_stride(type, i);
            }
            if (!member_type.array.empty()) {
                member.array.assign(member_type.array.begin(), member_type.array.end());
                std::ranges::reverse(member.array);  // SPIRV-Cross has the innermost first
                member.array_stride = compiler.type_struct_member_array_stride(type, i);
                for (size_t inner = 1; inner < member.array.size(); ++inner) {
                    if (member.array[inner] != 0) member.array_stride /= member.array[inner];
                }
                if (!std::ranges::all_of(member_type.array_size_literal,
                                         [](bool literal) { return literal; })) {
                    fault("{}.{}: the extents of arrays in blocks are literal numbers", block.name,
                          member.name);
                }
            }
            switch (member_type.basetype) {
                case SPIRType::Int:
                    member.scalar = ScalarType::sint;
                    break;
                case SPIRType::UInt:
                    member.scalar = ScalarType::uint;
                    break;
                case SPIRType::Float:
                    member.scalar = ScalarType::floating;
                    break;
                case SPIRType::Struct: {
                    const std::string name = compiler.get_name(member_type.self);
                    auto it = structs.find(name);
                    if (it == structs.end()) {
                        std::vector<BlockMember> inner = members_of(compiler, member_type, block, structs);
                        it = structs.emplace(name, int(block.structs.size())).first;
                        block.structs.push_back({name, std::move(inner)});
                    }
                    member.structure = it->second;
                    break;
                }
                default:
                    fault("{}.{}: not a type that blocks may hold", block.name, member.name);
            }
            members.push_back(std::move(member));
        }
        return members;
    }

    void add_push(const spirv_cross::Compiler& compiler, const Resource& resource) {
        const SPIRType& type = compiler.get_type(resource.base_type_id);
        Block block = block_of(compiler, type, compiler.get_name(resource.base_type_id));
        block.size = uint32_t((compiler.get_declared_struct_size(type) + 3) / 4 * 4);
        if (const std::string member = first_member_off_std140(block); !member.empty()) {
            return fault_at(
                declaration_of(block.name),
                "push constants: {} is elsewhere under std140, which OpenGL needs (arrays want 16-byte "
                "elements, structs 16-byte alignment)",
                member);
        }
        if (block.size > rhi::max_push_size) {
            return fault_at(declaration_of(block.name), "push constants take {} bytes; at most {} are there",
                            block.size, rhi::max_push_size);
        }
        if (reflection_.push.members.empty()) {
            reflection_.push = std::move(block);
        } else if (reflection_.push != block) {
            fault_at(declaration_of(block.name), "push constants: the stages do not declare the same block");
        }
    }

    void add_options(const spirv_cross::Compiler& compiler) {
        for (const spirv_cross::SpecializationConstant& constant : compiler.get_specialization_constants()) {
            const spirv_cross::SPIRConstant& value = compiler.get_constant(constant.id);
            const SPIRType& type = compiler.get_type(value.constant_type);
            Option option{.name = compiler.get_name(constant.id), .default_bits = value.scalar()};
            switch (type.basetype) {
                case SPIRType::Boolean:
                    option.type = rhi::OptionType::boolean;
                    break;
                case SPIRType::Int:
                    option.type = rhi::OptionType::sint;
                    break;
                case SPIRType::UInt:
                    option.type = rhi::OptionType::uint;
                    break;
                case SPIRType::Float:
                    option.type = rhi::OptionType::floating;
                    break;
                default:
                    fault_at(declaration_of(option.name), "constant_id {}: only bool, int, uint and float",
                             constant.constant_id);
                    continue;
            }
            if (option.name.empty()) continue;  // of a group size, which is refused on its own
            const auto [it, fresh] = options_.try_emplace(constant.constant_id, option);
            if (!fresh && it->second != option) {
                fault_at(declaration_of(option.name),
                         "constant_id {}: '{}' here and '{}' elsewhere are not declared alike",
                         constant.constant_id, option.name, it->second.name);
            }
        }
    }

    void add_local_size(const spirv_cross::Compiler& compiler) {
        spirv_cross::SpecializationConstant specialized[3];
        compiler.get_work_group_size_specialization_constants(specialized[0], specialized[1], specialized[2]);
        for (uint32_t axis = 0; axis < 3; ++axis) {
            if (uint32_t(specialized[axis].id) != 0) {
                return fault("the group size must be of literal numbers, not local_size_{}_id", "xyz"[axis]);
            }
            reflection_.local_size[axis] =
                compiler.get_execution_mode_argument(spv::ExecutionModeLocalSize, axis);
        }
    }

    const ProgramSource& source_;
    const std::vector<IncludedFile>& includes_;
    const StageSource* stage_ = nullptr;  // the one that is being added
    std::vector<std::string> faults_;
    std::map<uint32_t, Declaration> declarations_;
    std::map<uint32_t, Option> options_;
    Reflection reflection_;
};

}  // namespace

Result<Reflection> reflect(const ProgramSource& source, const FrontEndOutput& front) {
    try {
        Reflector reflector(source, front.includes);
        for (size_t i = 0; i < source.stages.size(); ++i)
            reflector.add_stage(source.stages[i], front.stages[i]);
        return reflector.finish();
    } catch (const spirv_cross::CompilerError& error) {
        return fail(ErrorKind::shader, source.name, std::string("reflection failed: ") + error.what());
    }
}

}  // namespace lumo::shadercompiler
