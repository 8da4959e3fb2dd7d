#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
    const lumo::Raster::Bindings bindings{.base_color = {r.color, r.sampler},
                                          .hits = r.hits,
#ifdef LUMO_RIGHT
                                          .Vertices = r.vertices,
#else
                                          .Vertices = r.color,
#endif
                                          .shadow = {r.shadow, r.sampler},
                                          .unused = {r.color, r.sampler}};
    return bindings;
}
