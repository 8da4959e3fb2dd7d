// What a SPIR-V module does to its storage resources, found by walking its instructions.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace lumo::shadercompiler {

struct Uses {
    bool atomic =
        false;  ///< by a commutative operation: add, sub, min, max, and, or, xor, increment, decrement
    bool plain = false;  ///< by any other read or write, exchange and compare-exchange among them
};

struct ModuleUses {
    std::unordered_map<uint32_t, Uses> of_variable;  ///< by the id of a module-scope variable
    std::vector<uint32_t> capabilities;
    bool is_volatile = false;  ///< something is decorated Volatile
};

/// Follows pointers and images through access chains, copies and function parameters.
ModuleUses find_uses(std::span<const uint32_t> spirv);

}  // namespace lumo::shadercompiler
