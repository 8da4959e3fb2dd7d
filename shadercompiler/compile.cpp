#include "shadercompiler/compile.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

#include "shadercompiler/front_end.hpp"
#include "shadercompiler/opengl.hpp"
#include "shadercompiler/program_code.hpp"
#include "shadercompiler/reflect.hpp"

namespace lumo::shadercompiler {
namespace {

namespace fs = std::filesystem;
using rhi::Stages;

/// In the order of the pipeline, which is also that of ProgramInfo::stages.
constexpr std::array<std::pair<const char*, Stages>, 4> stage_extensions = {{
    {".vert", Stages::vertex},
    {".geom", Stages::geometry},
    {".frag", Stages::fragment},
    {".comp", Stages::compute},
}};

Result<std::string> read_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file.is_open() || file.bad()) return fail(ErrorKind::io, path.string(), "cannot be read");
    return text;
}

/// Compute alone, or vertex with geometry and fragment as they come.
Result<void> check_stages(const ProgramSource& source) {
    Stages all = Stages::none;
    for (const StageSource& stage : source.stages) {
        if (rhi::has(all, stage.stage)) {
            return fail(ErrorKind::invalid_argument, source.name, "two files for one stage");
        }
        all |= stage.stage;
    }
    if (all != Stages::compute && (rhi::has(all, Stages::compute) || !rhi::has(all, Stages::vertex))) {
        return fail(ErrorKind::invalid_argument, source.name, "the stage files do not make a program",
                    "a program is a .comp alone, or a .vert with a .geom or a .frag or both");
    }
    return {};
}

}  // namespace

const rhi::ProgramInfo& CompiledProgram::info() const { return code_->info; }

Result<ProgramSource> read_program(const fs::path& root, const std::vector<fs::path>& files) {
    ProgramSource source;
    for (const auto& [extension, stage] : stage_extensions) {
        for (const fs::path& file : files) {
            if (file.extension() != extension) continue;
            const std::string name =
                fs::path(file).replace_extension().lexically_proximate(root).generic_string();
            if (!source.stages.empty() && name != source.name) {
                return fail(ErrorKind::invalid_argument, file.string(), "not a stage of " + source.name);
            }
            Result<std::string> text = read_text(file);
            if (!text) return tl::unexpected(text.error());
            source.name = name;
            source.stages.push_back({stage, file, std::move(*text)});
        }
    }
    if (source.stages.size() != files.size() || files.empty()) {
        return fail(ErrorKind::invalid_argument, source.name,
                    "stage files end in .vert, .geom, .frag or .comp");
    }
    if (Result<void> checked = check_stages(source); !checked) return tl::unexpected(checked.error());
    return source;
}

Result<ProgramSource> find_program(const fs::path& root, const std::string& name) {
    std::vector<fs::path> files;
    for (const auto& [extension, stage] : stage_extensions) {
        const fs::path file = root / (name + extension);
        std::error_code error;
        if (fs::is_regular_file(file, error)) files.push_back(file);
    }
    if (files.empty()) return fail(ErrorKind::io, (root / name).string(), "no shader of this name");
    return read_program(root, files);
}

Result<Compilation> compile_program(const ProgramSource& source, const CompileOptions& options) {
    if (Result<void> checked = check_stages(source); !checked) return tl::unexpected(checked.error());
    Result<FrontEndOutput> front = to_spirv(source, options);
    if (!front) return tl::unexpected(front.error());
    Result<Reflection> reflection = reflect(source, *front);
    if (!reflection) return tl::unexpected(reflection.error());

    auto code = std::make_shared<CompiledProgram::Code>();
    code->name = source.name;
    code->info.push_size = reflection->push.size;
    code->info.local_size = reflection->local_size;
    code->info.color_outputs = reflection->color_outputs;
    code->bindings = std::move(reflection->bindings);
    code->binding_names = std::move(reflection->binding_names);
    code->options = std::move(reflection->options);
    code->option_names = std::move(reflection->option_names);
    for (size_t i = 0; i < source.stages.size(); ++i) {
        const std::string path = source.stages[i].path.string();
        Result<Words> spirv = improve(path, front->stages[i], options.optimise);
        if (!spirv) return tl::unexpected(spirv.error());
        Result<std::string> glsl = to_opengl(path, *spirv, code->bindings);
        if (!glsl) return tl::unexpected(glsl.error());
        code->stages.push_back({source.stages[i].stage, std::move(*spirv), std::move(*glsl)});
    }
    code->complete();
    return Compilation{.program = CompiledProgram(std::move(code)),
                       .uniform_blocks = std::move(reflection->uniform_blocks),
                       .push = std::move(reflection->push),
                       .includes = std::move(front->includes)};
}

}  // namespace lumo::shadercompiler
