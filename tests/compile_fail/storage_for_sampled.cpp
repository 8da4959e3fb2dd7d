#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
    const lumo::Raster::Bindings bindings{
#ifdef LUMO_RIGHT
        .base_color = {r.color, r.sampler},
#else
        .base_color = r.color,
#endif
        .hits = r.hits,
        .Vertices = r.vertices,
        .shadow = {r.shadow, r.sampler},
        .unused = {r.color, r.sampler}};
    return bindings;
}
