// What a CompiledProgram owns.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shadercompiler/compile.hpp"
#include "shadercompiler/front_end.hpp"
#include "shadercompiler/reflect.hpp"

namespace lumo::shadercompiler {

struct StageCode {
    rhi::Stages stage{};
    Words spirv;
    std::string glsl;
};

/// Neither copied nor moved once `info` is set, which looks at the rest.
struct CompiledProgram::Code {
    std::string name;
    std::vector<StageCode> stages;
    std::vector<rhi::BindingInfo> bindings;
    std::vector<std::string> binding_names;
    std::vector<rhi::OptionInfo> options;
    std::vector<std::string> option_names;

    std::vector<rhi::StageInfo> stage_infos;
    rhi::ProgramInfo info;

    Code() = default;
    Code(const Code&) = delete;
    Code& operator=(const Code&) = delete;

    /// Points `info` and the views in it at the other members, and computes its hash. Its plain numbers are
    /// set before.
    void complete();
};

/// The code as bytes for the disk cache, and back. Bytes that were not written by this version give nothing.
std::vector<std::byte> to_bytes(const CompiledProgram::Code& code);
std::shared_ptr<const CompiledProgram::Code> from_bytes(std::span<const std::byte> bytes);

/// Of all that a compilation depends on and that is known before it. What was included, and its contents, is
/// in the entry.
rhi::CacheKey cache_key(const ProgramSource& source, const CompileOptions& options);
std::vector<std::byte> cache_entry(const Compilation& compilation);

}  // namespace lumo::shadercompiler
