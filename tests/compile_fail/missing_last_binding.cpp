#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
    const lumo::Raster::Bindings bindings{.base_color = {r.color, r.sampler},
                                          .hits = r.hits,
                                          .Vertices = r.vertices,
                                          .shadow = {r.shadow, r.sampler},
#ifdef LUMO_RIGHT
                                          .unused = {r.color, r.sampler}
#endif
    };
    return bindings;
}
