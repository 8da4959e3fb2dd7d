#include "tests/compile_fail/common.hpp"

lumo::Raster::Push fill(glm::vec2 offset, glm::vec3 position) {
#ifdef LUMO_RIGHT
    (void)position;
    return {.offset = offset, .layer = 1};
#else
    (void)offset;
    return {.offset = position, .layer = 1};
#endif
}
