#include "tests/compile_fail/common.hpp"

lumo::Raster::Bindings fill(const lumo::Resources& r) {
#ifdef LUMO_RIGHT
    const lumo::rhi::View<lumo::rhi::Dimension::d2> view = r.hits;
#else
    const lumo::rhi::TextureView view = r.hits;
#endif
    const lumo::Raster::Bindings bindings{.base_color = {r.color, r.sampler},
                                          .hits = view,
                                          .Vertices = r.vertices,
                                          .shadow = {r.shadow, r.sampler},
                                          .unused = {r.color, r.sampler}};
    return bindings;
}
