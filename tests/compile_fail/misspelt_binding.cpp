#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
    const lumo::Raster::Bindings bindings{.base_color = {r.color, r.sampler},
                                          .hits = r.hits,
                                          .Vertices = r.vertices,
#ifdef LUMO_RIGHT
                                          .shadow = {r.shadow, r.sampler},
#else
                                          .shadows = {r.shadow, r.sampler},
#endif
                                          .unused = {r.color, r.sampler}};
    return bindings;
}
