// What a program needs, read from its SPIR-V, and the rules of compile.hpp checked.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rhi/error.hpp"
#include "rhi/program.hpp"
#include "shadercompiler/block.hpp"
#include "shadercompiler/front_end.hpp"

namespace lumo::shadercompiler {

/// As rhi::ProgramInfo without its code; the names in `bindings` and `options` are empty and beside them
/// instead.
struct Reflection {
    std::vector<rhi::BindingInfo> bindings;
    std::vector<std::string> binding_names;
    std::vector<Block> uniform_blocks;  ///< one per uniform buffer, in order of binding
    std::vector<rhi::OptionInfo> options;
    std::vector<std::string> option_names;
    Block push;
    std::array<uint32_t, 3> local_size{1, 1, 1};
    uint32_t color_outputs = 0;
};

/// `front` is what became of `source`. Error: shader, with one line per broken rule.
Result<Reflection> reflect(const ProgramSource& source, const FrontEndOutput& front);

}  // namespace lumo::shadercompiler
