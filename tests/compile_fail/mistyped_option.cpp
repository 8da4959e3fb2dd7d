#include "tests/compile_fail/common.hpp"

lumo::Everything::Options fill(float value) {
#ifdef LUMO_RIGHT
    return {.bias = int(value), .scale = value};
#else
    return {.bias = value, .scale = value};
#endif
}
