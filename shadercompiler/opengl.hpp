// SPIR-V to the GLSL 450 that OpenGL compiles (SPIRV-Cross).
#pragma once

#include <span>
#include <string>

#include "rhi/error.hpp"
#include "rhi/program.hpp"
#include "shadercompiler/front_end.hpp"

namespace lumo::shadercompiler {

/// The text of one stage, with the slots of `bindings`, and push constants as a std140 block at
/// rhi::gl_push_slot. gl_InstanceIndex is gl_InstanceID. `path` is what errors call the stage.
Result<std::string> to_opengl(const std::string& path, const Words& spirv,
                              std::span<const rhi::BindingInfo> bindings);

}  // namespace lumo::shadercompiler
