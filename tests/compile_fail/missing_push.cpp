#include "tests/compile_fail/common.hpp"

lumo::Raster::Push fill(glm::vec2 offset) {
#ifdef LUMO_RIGHT
    return {.offset = offset, .layer = 1};
#else
    return {.offset = offset};
#endif
}
