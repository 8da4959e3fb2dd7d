#include "tests/compile_fail/common.hpp"

lumo::Everything::Options fill() {
#ifdef LUMO_RIGHT
    return {.fast = false};
#else
    return {.quick = false};
#endif
}
