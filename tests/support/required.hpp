// Whether what a test needs of its machine may be missing.
#pragma once

#include <cstdlib>
#include <string_view>

namespace lumo::testing_support {

/// The environment has LUMO_REQUIRE_APIS=1: a device, or a window system, that a test does not find is a failure.
inline bool apis_required() {
    const char* required = std::getenv("LUMO_REQUIRE_APIS");
    return required && std::string_view(required) == "1";
}

}  // namespace lumo::testing_support
