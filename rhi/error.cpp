#include "rhi/error.hpp"

namespace lumo {

std::string to_string(const Error& error) {
    std::string line = error.subject.empty() ? error.message : error.subject + ": " + error.message;
    if (!error.remedy.empty()) line += " (" + error.remedy + ")";
    return line;
}

}  // namespace lumo
