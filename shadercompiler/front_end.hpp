// GLSL to SPIR-V (glslang), and SPIR-V to better SPIR-V (SPIRV-Tools).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "shadercompiler/compile.hpp"

namespace lumo::shadercompiler {

using Words = std::vector<uint32_t>;

struct FrontEndOutput {
    std::vector<Words>
        stages;  ///< in the order of the source's stages; not optimised: names and unused bindings are in
    std::vector<IncludedFile> includes;  ///< in the order in which they were first read
};

/// Parses all stages and checks that their interfaces fit. Errors: see compile_program.
Result<FrontEndOutput> to_spirv(const ProgramSource& source, const CompileOptions& options);

/// Inlines all functions; with `optimise`, improves the code by SPIRV-Tools' performance passes. The result
/// is valid for Vulkan 1.3. `name` is what errors call the code.
Result<Words> improve(const std::string& name, const Words& spirv, bool optimise);

}  // namespace lumo::shadercompiler
