// All that OpenGL 4.5 core lets one read of a context's state, to see that it is as it was left.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace embed {

/// By name, such as "GL_BLEND[3]", the value as text.
using StateDump = std::map<std::string, std::string>;

/// Of the current context. It changes nothing, but reads the error flag.
StateDump dump_state();

/// A line for each name whose value differs.
std::vector<std::string> differences(const StateDump& before, const StateDump& after);

}  // namespace embed
