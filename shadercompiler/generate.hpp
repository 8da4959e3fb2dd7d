// The C++ that a program is used through.
#pragma once

#include <string>

#include "rhi/error.hpp"
#include "shadercompiler/compile.hpp"

namespace lumo::shadercompiler {

struct Generated {
    std::string header;  ///< to be "shaders/FOLDER/STEM.hpp"
    std::string source;  ///< beside it, "STEM.cpp": the code
};

/// The program FOLDER/STEM becomes the type lumo::shaders::FOLDER::STEM, which is an rhi::Program and has
/// besides:
///   - in Bindings, one member per binding, by ascending binding number, named as in GLSL (a block by its
///   instance, or
///     by its own name where it has none);
///   - a struct for each uniform block, named as the block, with GLSL's offsets asserted; bool becomes
///   uint32_t;
///   - Push likewise, and Options with the defaults of the source, by ascending id.
/// Error: shader, for what C++ cannot express: names that are keywords or taken, and in blocks arrays whose
/// elements are not as large as their stride (float[], vec3[]), matrices whose columns are not vec4,
/// row-major ones.
Result<Generated> generate_cpp(const Compilation& compilation);

}  // namespace lumo::shadercompiler
