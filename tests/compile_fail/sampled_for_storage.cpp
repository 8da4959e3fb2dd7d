#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
    const lumo::Raster::Bindings bindings{.base_color = {r.color, r.sampler},
#ifdef LUMO_RIGHT
                                          .hits = r.hits,
#else
                                          .hits = {r.hits, r.sampler},
#endif
                                          .Vertices = r.vertices,
                                          .shadow = {r.shadow, r.sampler},
                                          .unused = {r.color, r.sampler}};
    return bindings;
}
