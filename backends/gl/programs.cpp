#include "backends/gl/programs.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "backends/gl/resources.hpp"

namespace lumo::backends::gl {
namespace {

struct GlStage {
    GLenum kind;
    std::string_view name;
};

GlStage gl_stage(rhi::Stages stage) {
    if (stage == rhi::Stages::vertex) return {GL_VERTEX_SHADER, "vertex"};
    if (stage == rhi::Stages::geometry) return {GL_GEOMETRY_SHADER, "geometry"};
    if (stage == rhi::Stages::fragment) return {GL_FRAGMENT_SHADER, "fragment"};
    return {GL_COMPUTE_SHADER, "compute"};
}

/// A constant expression with exactly these bits, whatever they mean.
std::string literal(rhi::OptionType type, uint32_t bits) {
    switch (type) {
        case rhi::OptionType::boolean:
            return bits ? "true" : "false";
        case rhi::OptionType::sint:
            return fmt::format("int({}u)", bits);
        case rhi::OptionType::uint:
            return fmt::format("{}u", bits);
        case rhi::OptionType::floating:
            return fmt::format("uintBitsToFloat({}u)", bits);
    }
    return {};
}

std::string option_macros(const rhi::ProgramInfo& info, std::span<const uint32_t> options) {
    std::string macros;
    for (size_t i = 0; i < options.size(); ++i) {
        macros += fmt::format("#define SPIRV_CROSS_CONSTANT_ID_{} {}\n", info.options[i].id,
                              literal(info.options[i].type, options[i]));
    }
    return macros;
}

/// The log of a shader or of a program.
template <class GetNumber, class GetLog>
std::string read_log(GLuint name, GetNumber get_number, GetLog get_log) {
    GLint length = 0;
    get_number(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(size_t(length), '\0');
    if (length > 0) get_log(name, length, &length, log.data());
    log.resize(size_t(length));
    log.erase(log.find_last_not_of("\n ") + 1);
    return log;
}

tl::unexpected<Error> no_memory_for(const rhi::ProgramInfo& info) {
    (void)check_errors(info.name);
    return out_of_memory(info.name);
}

Result<void> attach_stage(GLuint program, const rhi::ProgramInfo& info, const rhi::StageInfo& stage,
                          const std::string& macros) {
    const size_t after_version = stage.glsl.find('\n') + 1;
    const GLchar* texts[] = {stage.glsl.data(), macros.data(), stage.glsl.data() + after_version};
    const GLint lengths[] = {GLint(after_version), GLint(macros.size()),
                             GLint(stage.glsl.size() - after_version)};
    const GlStage kind = gl_stage(stage.stage);
    const GLuint shader = glCreateShader(kind.kind);
    if (!shader) return no_memory_for(info);
    glShaderSource(shader, 3, texts, lengths);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // lives on with the program
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return {};
    if (auto status = check_errors(info.name); !status) return status;
    return fail(ErrorKind::shader, std::string(info.name),
                fmt::format("the {} stage does not compile: {}", kind.name,
                            read_log(shader, glGetShaderiv, glGetShaderInfoLog)));
}

Result<void> link_stages(GLuint program, const rhi::ProgramInfo& info, std::span<const uint32_t> options) {
    const std::string macros = option_macros(info, options);
    for (const rhi::StageInfo& stage : info.stages) {
        if (auto attached = attach_stage(program, info, stage, macros); !attached) return attached;
    }
    glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
    glLinkProgram(program);
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) return {};
    if (auto status = check_errors(info.name); !status) return status;
    return fail(ErrorKind::shader, std::string(info.name),
                fmt::format("it does not link: {}", read_log(program, glGetProgramiv, glGetProgramInfoLog)));
}

rhi::CacheKey binary_key(const rhi::ProgramInfo& info, std::span<const uint32_t> options,
                         const rhi::DeviceInfo& device) {
    rhi::KeyBuilder key;
    key.add("OpenGL program binary").add(device.name).add(device.driver).add(info.name).add(info.hash);
    for (const rhi::StageInfo& stage : info.stages) key.add(stage.glsl);
    return key.add(std::as_bytes(options)).key();
}

/// An entry is the driver's name of the binary's format, then the binary.
bool load_binary(GLuint program, std::span<const std::byte> entry) {
    GLenum format = GL_NONE;
    if (entry.size() <= sizeof format) return false;
    std::memcpy(&format, entry.data(), sizeof format);
    GLint count = 0;
    glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &count);
    std::vector<GLint> formats(size_t(count), GL_NONE);
    glGetIntegerv(GL_PROGRAM_BINARY_FORMATS, formats.data());
    if (std::ranges::find(formats, GLint(format)) == formats.end()) return false;
    glProgramBinary(program, format, entry.data() + sizeof format, GLsizei(entry.size() - sizeof format));
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    return linked == GL_TRUE;
}

std::vector<std::byte> save_binary(GLuint program) {
    GLint size = 0;
    glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &size);
    if (size <= 0) return {};
    GLenum format = GL_NONE;
    std::vector<std::byte> entry(sizeof format + size_t(size));
    glGetProgramBinary(program, size, &size, &format, entry.data() + sizeof format);
    std::memcpy(entry.data(), &format, sizeof format);
    entry.resize(sizeof format + size_t(size));
    return entry;
}

}  // namespace

Result<GLuint> make_program(const rhi::ProgramInfo& info, std::span<const uint32_t> options,
                            const rhi::DeviceInfo& device, const rhi::DiskCache& cache) {
    const rhi::CacheKey key = binary_key(info, options, device);
    const GLuint program = glCreateProgram();
    if (!program) return no_memory_for(info);
    if (auto entry = cache.get(key); entry && load_binary(program, *entry)) return program;
    (void)check_errors(info.name);  // of the binary, without which it works as well
    if (auto linked = link_stages(program, info, options); !linked) {
        glDeleteProgram(program);
        return tl::unexpected(linked.error());
    }
    // A cache that cannot be written costs time in the next run, and nothing else.
    if (auto binary = save_binary(program); !binary.empty()) (void)cache.put(key, binary);
    return program;
}

}  // namespace lumo::backends::gl
