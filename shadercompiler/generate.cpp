#include "shadercompiler/generate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <set>
#include <span>
#include <string_view>

#include "rhi/program.hpp"

namespace lumo::shadercompiler {
namespace {

using rhi::BindingInfo;
using rhi::BindingKind;

constexpr std::string_view keywords[] = {
    "alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
    "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
    "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
    "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
    "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
    "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
    "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
    "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
    "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
    "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
    "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
    "true",        "try",      "typedef",    "typeid",    "typename",  "union",        "unsigned",
    "using",       "virtual",  "void",       "volatile",  "wchar_t",   "while",        "xor",
    "xor_eq",
};

bool is_identifier(std::string_view text) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && letter(text[0]) &&
           std::ranges::all_of(text, [&](char c) { return letter(c) || digit(c); }) &&
           std::ranges::find(keywords, text) == std::end(keywords);
}

std::string_view spelling(rhi::Dimension dimension) {
    constexpr std::string_view names[] = {"d1",       "d2",       "d3",         "cube",
                                          "d1_array", "d2_array", "cube_array", "d2_multisample"};
    return names[size_t(dimension)];
}

std::string_view spelling(rhi::TexelKind kind) {
    constexpr std::string_view names[] = {"floating", "uint", "sint"};
    return names[size_t(kind)];
}

std::string_view spelling(BindingKind kind) {
    constexpr std::string_view names[] = {"sampled", "storage_image", "storage_buffer", "uniform_buffer"};
    return names[size_t(kind)];
}

std::string_view spelling(rhi::ShaderAccess access) {
    constexpr std::string_view names[] = {"read", "write", "read_write", "atomic"};
    return names[size_t(access)];
}

std::string_view spelling(rhi::OptionType type) {
    constexpr std::string_view names[] = {"boolean", "sint", "uint", "floating"};
    return names[size_t(type)];
}

std::string_view spelling(rhi::Stages stage) {
    switch (stage) {
        case rhi::Stages::vertex:
            return "vertex";
        case rhi::Stages::geometry:
            return "geometry";
        case rhi::Stages::fragment:
            return "fragment";
        case rhi::Stages::compute:
            return "compute";
        default:
            return "none";
    }
}

std::string stages_expression(rhi::Stages stages) {
    std::string text;
    for (const auto stage :
         {rhi::Stages::vertex, rhi::Stages::geometry, rhi::Stages::fragment, rhi::Stages::compute}) {
        if (!rhi::has(stages, stage)) continue;
        text += fmt::format("{}rhi::Stages::{}", text.empty() ? "" : " | ", spelling(stage));
    }
    return text.empty() ? "rhi::Stages::none" : text;
}

std::string cpp_type(const BindingInfo& binding) {
    switch (binding.kind) {
        case BindingKind::storage_buffer:
            return "rhi::StorageBuffer";
        case BindingKind::uniform_buffer:
            return "rhi::UniformBuffer";
        default:
            break;
    }
    const std::string_view shape = binding.kind == BindingKind::sampled ? "Sampled" : "StorageImage";
    if (binding.texel == rhi::TexelKind::floating) {
        return fmt::format("rhi::{}<rhi::Dimension::{}>", shape, spelling(binding.dimension));
    }
    return fmt::format("rhi::{}<rhi::Dimension::{}, rhi::TexelKind::{}>", shape, spelling(binding.dimension),
                       spelling(binding.texel));
}

std::string binding_comment(const BindingInfo& binding, const Block* block) {
    switch (binding.kind) {
        case BindingKind::sampled:
            return fmt::format("binding {}", binding.binding);
        case BindingKind::storage_image:
            return fmt::format("binding {}, {}, {}", binding.binding, rhi::format_info(binding.format).name,
                               spelling(binding.access));
        case BindingKind::storage_buffer:
            return fmt::format("binding {}, at least {} bytes, {}", binding.binding, binding.min_size,
                               spelling(binding.access));
        default:
            return fmt::format("binding {}, a {}", binding.binding, block->name);
    }
}

std::string float_literal(uint32_t bits) {
    const float value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) return fmt::format("std::bit_cast<float>(uint32_t(0x{:08x}))", bits);
    std::string text = fmt::format("{:.9g}", value);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text + "f";
}

/// A program's C++ text, and every reason why there is none.
class Generator {
  public:
    explicit Generator(const Compilation& compilation)
        : compilation_(compilation), info_(compilation.program.info()) {}

    Result<Generated> generate() {
        split_name();
        const std::string body = program_type();
        Generated generated{.header = header(body), .source = source()};
        if (!faults_.empty()) {
            return fail(ErrorKind::shader, std::string(info_.name),
                        fmt::format("\n{}", fmt::join(faults_, "\n")));
        }
        return generated;
    }

  private:
    template <class... Args>
    void fault(fmt::format_string<Args...> format, Args&&... args) {
        faults_.push_back(
            fmt::format("{}: error: {}", info_.name, fmt::format(format, std::forward<Args>(args)...)));
    }

    void split_name() {
        namespace_ = "lumo::shaders";
        std::string_view rest = info_.name;
        for (size_t slash = rest.find('/'); slash != std::string_view::npos; slash = rest.find('/')) {
            if (!is_identifier(rest.substr(0, slash))) fault("the folder's name is no C++ identifier");
            namespace_ += fmt::format("::{}", rest.substr(0, slash));
            rest.remove_prefix(slash + 1);
        }
        type_ = rest;
        if (!is_identifier(type_)) fault("the file's name is no C++ identifier");
        if (namespace_ == "lumo::shaders") fault("programs live in a folder below the root of the shaders");
    }

    /// Checks a name against C++ and the others of the same scope.
    void claim(std::set<std::string, std::less<>>& scope, std::string_view name) {
        if (!is_identifier(name)) fault("'{}' is no C++ identifier", name);
        if (!scope.emplace(name).second) fault("'{}' is a name that the C++ type has already", name);
    }

    // Structs of blocks

    /// The C++ type of a member with its size in bytes; a fault where the layout is beyond C++.
    std::pair<std::string, uint32_t> member_type(const Block& block, const BlockMember& member) {
        std::string type;
        uint32_t size = 0;
        if (member.structure >= 0) {
            const BlockStruct& s = block.structs[size_t(member.structure)];
            type = s.name;
            size = struct_size(block, s);
        } else if (member.columns > 1) {
            if (member.row_major || member.rows != 4 || member.scalar != ScalarType::floating) {
                fault(
                    "{}.{}: C++ cannot express this matrix's layout; use mat4, mat3x4, mat2x4 or vec4 "
                    "columns",
                    block.name, member.name);
            }
            type = member.columns == 4 ? "glm::mat4" : fmt::format("glm::mat{}x4", member.columns);
            use_glm(fmt::format("mat{}x4", member.columns));
            size = 16 * member.columns;
        } else {
            constexpr std::string_view scalars[] = {"int32_t", "uint32_t", "float"};
            constexpr std::string_view prefixes[] = {"i", "u", ""};
            if (member.rows == 1) {
                type = scalars[size_t(member.scalar)];
            } else {
                type = fmt::format("glm::{}vec{}", prefixes[size_t(member.scalar)], member.rows);
                use_glm(fmt::format("vec{}", member.rows));
            }
            size = 4 * member.rows;
        }
        if (!member.array.empty() && size != member.array_stride) {
            fault("{}.{}: C++ cannot express an array of {} bytes every {}; use vec4 elements or a struct",
                  block.name, member.name, size, member.array_stride);
        }
        for (size_t i = member.array.size(); i-- > 0;) {
            type = fmt::format("std::array<{}, {}>", type, member.array[i]);
            size *= member.array[i];
        }
        return {type, size};
    }

    uint32_t struct_size(const Block& block, const BlockStruct& s) {
        const BlockMember& last = s.members.back();
        return (last.offset + member_type(block, last).second + 15) / 16 * 16;
    }

    std::string struct_text(const Block& block, const std::string& name, std::span<const BlockMember> members,
                            uint32_t size) {
        std::string text = fmt::format("    struct {} {{\n", name);
        uint32_t end = 0;
        const auto pad_to = [&](uint32_t offset) {
            if (offset <= end) return;
            text +=
                fmt::format("        std::array<uint32_t, {}> padding_{}{{}};\n", (offset - end) / 4, end);
            end = offset;
        };
        std::set<std::string, std::less<>> scope;
        for (const BlockMember& member : members) {
            claim(scope, member.name);
            const auto [type, bytes] = member_type(block, member);
            pad_to(member.offset);
            text += fmt::format("        {} {};\n", type, member.name);
            end += bytes;
            asserts_ += fmt::format("static_assert(offsetof({}::{}, {}) == {});\n", type_, name, member.name,
                                    member.offset);
        }
        pad_to(size);
        asserts_ += fmt::format("static_assert(sizeof({}::{}) == {});\n", type_, name, size);
        return text + "    };\n";
    }

    /// The structs that a block uses, then its own under `name`. A struct that several blocks use appears
    /// once.
    std::string block_text(const Block& block, const std::string& name) {
        std::string text;
        for (const BlockStruct& s : block.structs) {
            if (const auto it = std::ranges::find(structs_, s.name, &BlockStruct::name);
                it != structs_.end()) {
                if (*it != s) fault("struct {} has two layouts", s.name);
                continue;
            }
            claim(types_, s.name);
            structs_.push_back(s);
            text += struct_text(block, s.name, s.members, struct_size(block, s)) + "\n";
        }
        claim(types_, name);
        return text + struct_text(block, name, block.members, block.size);
    }

    void use_glm(const std::string& file) { glm_.insert(file); }

    // The type

    std::string bindings_text() {
        std::string text = "    struct Bindings {\n";
        std::set<std::string, std::less<>> scope = {"values"};
        std::vector<std::string> values;
        auto block = compilation_.uniform_blocks.begin();
        for (const BindingInfo& binding : info_.bindings) {
            claim(scope, binding.name);
            const bool uniform = binding.kind == BindingKind::uniform_buffer;
            const Block* of_binding = uniform ? &*block++ : nullptr;
            text += fmt::format("        {} {};  ///< {}\n", cpp_type(binding), binding.name,
                                binding_comment(binding, of_binding));
            values.push_back(fmt::format("rhi::BindingValue({})", binding.name));
        }
        if (!values.empty()) text += "\n";
        text += fmt::format(
            "        std::array<rhi::BindingValue, {}> values() const {{\n"
            "            return {{{}}};\n"
            "        }}\n"
            "    }};\n",
            values.size(), fmt::join(values, ",\n                    "));
        return text;
    }

    std::string options_text() {
        if (info_.options.empty()) return "    using Options = rhi::NoOptions;\n";
        constexpr std::string_view types[] = {"bool", "int32_t", "uint32_t", "float"};
        std::string text = "    struct Options {\n";
        std::set<std::string, std::less<>> scope = {"values"};
        std::vector<std::string> values;
        for (const rhi::OptionInfo& option : info_.options) {
            claim(scope, option.name);
            std::string initial;
            std::string bits = fmt::format("uint32_t({})", option.name);
            switch (option.type) {
                case rhi::OptionType::boolean:
                    initial = option.default_bits != 0 ? "true" : "false";
                    break;
                case rhi::OptionType::sint:
                    initial = fmt::format("int32_t({}u)", option.default_bits);
                    break;
                case rhi::OptionType::uint:
                    initial = fmt::format("{}u", option.default_bits);
                    break;
                case rhi::OptionType::floating:
                    initial = float_literal(option.default_bits);
                    bits = fmt::format("std::bit_cast<uint32_t>({})", option.name);
                    break;
            }
            if (option.type == rhi::OptionType::sint && int32_t(option.default_bits) >= 0) {
                initial = fmt::format("{}", option.default_bits);
            }
            text += fmt::format("        {} {} = {};  ///< constant_id {}\n", types[size_t(option.type)],
                                option.name, initial, option.id);
            values.push_back(bits);
        }
        text += fmt::format(
            "\n"
            "        std::array<uint32_t, {}> values() const {{\n"
            "            return {{{}}};\n"
            "        }}\n"
            "    }};\n",
            values.size(), fmt::join(values, ", "));
        return text;
    }

    std::string program_type() {
        types_ = {"Bindings", "Push", "Options", "info", type_};
        std::string text = fmt::format("struct {} {{\n", type_);
        for (const Block& block : compilation_.uniform_blocks) text += block_text(block, block.name) + "\n";
        text += bindings_text() + "\n";
        if (compilation_.push.members.empty()) {
            text += "    using Push = rhi::NoPush;\n";
        } else {
            types_.erase("Push");
            text += block_text(compilation_.push, "Push");
            asserts_ += fmt::format("static_assert(sizeof({}::Push) <= rhi::max_push_size);\n", type_);
        }
        text += "\n" + options_text();
        text += "\n    static const rhi::ProgramInfo& info();\n};\n";
        return text;
    }

    std::string header(const std::string& body) const {
        std::string glm;
        for (const std::string& file : glm_) {
            glm += fmt::format("#include <glm/{}.hpp>\n",
                               file.starts_with("mat") ? "mat" + file.substr(3) : file);
        }
        return fmt::format(
            "// Made by lumo_shaderc from the shader program {}.\n"
            "#pragma once\n\n"
            "#include <array>\n#include <bit>\n#include <cstddef>\n#include <cstdint>\n{}\n"
            "#include \"rhi/bindings.hpp\"\n#include \"rhi/program.hpp\"\n\n"
            "namespace {} {{\n\n{}\n{}{}}}  // namespace {}\n",
            info_.name, glm, namespace_, body, asserts_, asserts_.empty() ? "" : "\n", namespace_);
    }

    // The code

    std::string source() const {
        std::string arrays;
        std::string stages;
        for (const rhi::StageInfo& stage : info_.stages) {
            const std::string_view name = spelling(stage.stage);
            arrays += fmt::format("constexpr uint32_t {}_spirv[] = {{", name);
            for (size_t i = 0; i < stage.spirv.size(); ++i) {
                arrays += fmt::format("{}0x{:x},", i % 12 == 0 ? "\n    " : " ", stage.spirv[i]);
            }
            arrays += "\n};\n\n";
            // With its length: compilers count no further than 262 144 characters for a constant.
            arrays += fmt::format("constexpr std::string_view {}_glsl(R\"glsl({})glsl\", {});\n\n", name,
                                  stage.glsl, stage.glsl.size());
            stages += fmt::format("    {{rhi::Stages::{0}, {0}_spirv, {0}_glsl}},\n", name);
        }
        std::string bindings;
        for (const BindingInfo& b : info_.bindings) {
            bindings += fmt::format(
                "    {{.name = \"{}\",\n"
                "     .binding = {},\n"
                "     .kind = rhi::BindingKind::{},\n"
                "     .dimension = rhi::Dimension::{},\n"
                "     .texel = rhi::TexelKind::{},\n"
                "     .format = rhi::Format::{},\n"
                "     .access = rhi::ShaderAccess::{},\n"
                "     .stages = {},\n"
                "     .gl_slot = {},\n"
                "     .min_size = {}}},\n",
                b.name, b.binding, spelling(b.kind), spelling(b.dimension), spelling(b.texel),
                rhi::format_info(b.format).name, spelling(b.access), stages_expression(b.stages), b.gl_slot,
                b.min_size);
        }
        std::string options;
        for (const rhi::OptionInfo& o : info_.options) {
            options += fmt::format(
                "    {{.name = \"{}\", .id = {}, .type = rhi::OptionType::{}, .default_bits = 0x{:x}}},\n",
                o.name, o.id, spelling(o.type), o.default_bits);
        }
        const auto table = [](std::string_view type, std::string_view name, const std::string& rows) {
            return rows.empty() ? std::string()
                                : fmt::format("constexpr {} {}[] = {{\n{}}};\n\n", type, name, rows);
        };
        return fmt::format(
            "// Made by lumo_shaderc from the shader program {0}.\n"
            "#include \"shaders/{0}.hpp\"\n\n"
            "#include <string_view>\n\n"
            "namespace {1} {{\n"
            "namespace {{\n\n"
            "{2}{3}{4}{5}"
            "}}  // namespace\n\n"
            "const rhi::ProgramInfo& {6}::info() {{\n"
            "    static constexpr rhi::ProgramInfo program{{\n"
            "        .name = \"{0}\",\n"
            "        .stages = stages,\n"
            "        .bindings = {7},\n"
            "        .options = {8},\n"
            "        .push_size = {9},\n"
            "        .local_size = {{{10}}},\n"
            "        .color_outputs = 0x{11:x},\n"
            "        .hash = 0x{12:x},\n"
            "    }};\n"
            "    return program;\n"
            "}}\n\n"
            "}}  // namespace {1}\n",
            info_.name, namespace_, arrays, table("rhi::StageInfo", "stages", stages),
            table("rhi::BindingInfo", "bindings", bindings), table("rhi::OptionInfo", "options", options),
            type_, bindings.empty() ? "{}" : "bindings", options.empty() ? "{}" : "options", info_.push_size,
            fmt::join(info_.local_size, ", "), info_.color_outputs, info_.hash);
    }

    const Compilation& compilation_;
    const rhi::ProgramInfo& info_;
    std::vector<std::string> faults_;
    std::string namespace_;
    std::string type_;
    std::set<std::string, std::less<>> types_;
    std::set<std::string> glm_;
    std::vector<BlockStruct> structs_;
    std::string asserts_;
};

}  // namespace

Result<Generated> generate_cpp(const Compilation& compilation) { return Generator(compilation).generate(); }

}  // namespace lumo::shadercompiler
