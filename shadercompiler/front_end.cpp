#include "shadercompiler/front_end.hpp"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <iterator>
#include <memory>
#include <optional>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>
#include <string_view>

namespace lumo::shadercompiler {
namespace {

namespace fs = std::filesystem;

constexpr const char* prelude_name = "(prelude)";

EShLanguage language_of(rhi::Stages stage) {
    switch (stage) {
        case rhi::Stages::vertex:
            return EShLangVertex;
        case rhi::Stages::geometry:
            return EShLangGeometry;
        case rhi::Stages::fragment:
            return EShLangFragment;
        default:
            return EShLangCompute;
    }
}

std::string prelude(const CompileOptions& options) {
    std::string text =
        "#version 450\n"
        "#extension GL_GOOGLE_include_directive : require\n"
        "#define LUMO_READ_WRITE restrict\n";
    for (const auto& [name, value] : options.defines) text += fmt::format("#define {} {}\n", name, value);
    return text;
}

/// Finds files below the include roots. Each is given out once; later inclusions are empty.
class Includer : public glslang::TShader::Includer {
  public:
    Includer(const std::vector<fs::path>& roots, std::vector<IncludedFile>& read)
        : roots_(roots), read_(read) {}

    IncludeResult* includeLocal(const char* name, const char*, size_t) override {
        for (const fs::path& root : roots_) {
            const fs::path path = (root / name).lexically_normal();
            if (!fs::is_regular_file(path)) continue;
            if (std::ranges::find(seen_, path) != seen_.end()) return answer(path.string(), "");
            std::ifstream file(path, std::ios::binary);
            std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
            if (!file.is_open() || file.bad()) return answer("", path.string() + ": cannot be read");
            if (!text.ends_with('\n')) text += '\n';
            seen_.push_back(path);
            if (std::ranges::find(read_, path, &IncludedFile::path) == read_.end())
                read_.push_back({path, text});
            return answer(path.string(), std::move(text));
        }
        return nullptr;
    }

    /// For <name>, and for "name" where it was not found.
    IncludeResult* includeSystem(const char* name, const char*, size_t) override {
        std::vector<std::string> roots;
        for (const fs::path& root : roots_) roots.push_back(root.string());
        return answer("", fmt::format("no \"{}\" in the include roots ({}); <> is not searched", name,
                                      fmt::join(roots, ", ")));
    }

    void releaseInclude(IncludeResult*) override {}  // results live as long as the includer

  private:
    /// An empty name says that the text is a fault.
    IncludeResult* answer(const std::string& name, std::string text) {
        const std::string& kept = texts_.emplace_back(std::move(text));
        return &results_.emplace_back(name, kept.data(), kept.size(), nullptr);
    }

    const std::vector<fs::path>& roots_;
    std::vector<IncludedFile>& read_;
    std::vector<fs::path> seen_;
    std::deque<std::string> texts_;
    std::deque<IncludeResult> results_;
};

/// Where "PATH:LINE:" at the start of the text ends, before its last colon; npos without it.
size_t end_of_place(std::string_view text) {
    for (size_t at = text.find(':'); at != std::string_view::npos; at = text.find(':', at + 1)) {
        const size_t end = text.find_first_not_of("0123456789", at + 1);
        if (end != std::string_view::npos && end > at + 1 && text[end] == ':') return end;
    }
    return std::string_view::npos;
}

/// glslang's log says "ERROR: PATH:LINE: WHAT", or without a place but with indented lines of detail. The
/// result says "PATH:LINE: error: WHAT", one line per fault.
std::string readable(std::string_view log, const std::string& fallback_path) {
    std::vector<std::string> faults;
    bool in_fault = false;
    while (!log.empty()) {
        const size_t end = std::min(log.find('\n'), log.size());
        std::string_view line = log.substr(0, end);
        log.remove_prefix(std::min(end + 1, log.size()));
        while (line.ends_with(' ')) line.remove_suffix(1);
        if (line.starts_with(' ') && in_fault) {
            faults.back() += line.substr(line.find_first_not_of(' ') - 1);
            continue;
        }
        constexpr std::string_view tag = "ERROR: ";
        in_fault = line.starts_with(tag) && line.find("compilation errors") == std::string_view::npos &&
                   line.find("compilation terminated") == std::string_view::npos;
        if (!in_fault) continue;
        line.remove_prefix(tag.size());
        const size_t place = end_of_place(line);
        faults.push_back(place == std::string_view::npos
                             ? fmt::format("{}: error: {}", fallback_path, line)
                             : fmt::format("{}: error:{}", line.substr(0, place), line.substr(place + 1)));
    }
    if (faults.empty()) return fallback_path + ": error: the compiler failed without a message";
    return fmt::format("{}", fmt::join(faults, "\n"));
}

struct GlslangProcess {
    GlslangProcess() { glslang::InitializeProcess(); }
    ~GlslangProcess() { glslang::FinalizeProcess(); }
};

}  // namespace

Result<FrontEndOutput> to_spirv(const ProgramSource& source, const CompileOptions& options) {
    static const GlslangProcess process;
    constexpr auto messages = EShMessages(EShMsgSpvRules | EShMsgVulkanRules);
    const std::string prelude_text = prelude(options);

    FrontEndOutput output;
    std::deque<glslang::TShader> shaders;
    glslang::TProgram program;  // destroyed before the shaders that it refers to
    for (const StageSource& stage : source.stages) {
        const std::string path = stage.path.string();
        const char* texts[] = {prelude_text.c_str(), stage.text.c_str()};
        const int lengths[] = {int(prelude_text.size()), int(stage.text.size())};
        const char* names[] = {prelude_name, path.c_str()};
        glslang::TShader& shader = shaders.emplace_back(language_of(stage.stage));
        shader.setStringsWithLengthsAndNames(texts, lengths, names, 2);
        shader.setEnvInput(glslang::EShSourceGlsl, language_of(stage.stage), glslang::EShClientVulkan, 100);
        shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
        shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
        Includer includer(options.include_roots, output.includes);
        if (!shader.parse(GetDefaultResources(), 450, false, messages, includer)) {
            return fail(ErrorKind::shader, source.name,
                        fmt::format("\n{}", readable(shader.getInfoLog(), path)));
        }
        program.addShader(&shader);
    }
    if (!program.link(messages)) {
        return fail(ErrorKind::shader, source.name,
                    fmt::format("\n{}", readable(program.getInfoLog(), source.name)));
    }
    for (const StageSource& stage : source.stages) {
        glslang::SpvOptions spv_options;
        spv_options.disableOptimizer = true;
        spv::SpvBuildLogger logger;
        Words words;
        glslang::GlslangToSpv(*program.getIntermediate(language_of(stage.stage)), words, &logger,
                              &spv_options);
        if (words.empty()) {
            return fail(ErrorKind::shader, source.name,
                        fmt::format("{}: error: {}", stage.path.string(), logger.getAllMessages()));
        }
        output.stages.push_back(std::move(words));
    }
    return output;
}

Result<Words> improve(const std::string& name, const Words& spirv, bool optimise) {
    constexpr spv_target_env environment = SPV_ENV_VULKAN_1_3;
    std::string messages;
    const auto collect = [&](spv_message_level_t level, const char*, const spv_position_t&,
                             const char* text) {
        if (level <= SPV_MSG_ERROR) messages += (messages.empty() ? "" : "; ") + std::string(text);
    };
    spvtools::Optimizer optimizer(environment);
    optimizer.SetMessageConsumer(collect);
    if (optimise) {
        optimizer.RegisterPerformancePasses();
    } else {
        optimizer.RegisterPass(spvtools::CreateWrapOpKillPass())
            .RegisterPass(spvtools::CreateMergeReturnPass())
            .RegisterPass(spvtools::CreateInlineExhaustivePass())
            .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass());
    }
    spvtools::OptimizerOptions run_options;
    run_options.set_run_validator(false);
    Words result;
    if (!optimizer.Run(spirv.data(), spirv.size(), &result, run_options)) {
        return fail(ErrorKind::shader, name, "the SPIR-V optimiser failed: " + messages);
    }
    spvtools::SpirvTools validator(environment);
    validator.SetMessageConsumer(collect);
    if (!validator.Validate(result)) {
        return fail(ErrorKind::shader, name, "the SPIR-V is not valid for Vulkan: " + messages);
    }
    return result;
}

}  // namespace lumo::shadercompiler
