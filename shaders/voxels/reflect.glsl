// Light of the analytic lights on a voxel's surfaces, as their shadow maps saw it. The includer defines FLUX, the
// binding of the sums.
#include "common/constants.glsl"
#include "common/voxel_grid.glsl"
#include "voxels/flux.glsl"

layout(binding = FLUX, r32ui) readonly uniform uimage3D direct_flux;

// What the words count.
struct FluxUnits {
    vec3 flux;       // per count, in W over the area of a voxel face; of one directional light per count of what is lit
    float lit_area;  // per count, in voxel faces, on a plane that faces the light
    float lights;    // how many may light one place
};

// Mean irradiance over a voxel's surfaces, W/m²: the flux over their area. The area is counted too, up to about a third
// too small, so it is not held to what is lit, which would lose flux; but where what is lit is far more, the area is
// that of a sliver badly estimated.
vec3 direct_irradiance(FluxUnits units, ivec3 cell, float encoded_area) {
    uint lit = imageLoad(direct_flux, flux_texel(cell, 0)).r;
    vec3 counts = vec3(lit);
    if (several_lights) {
        counts = vec3(imageLoad(direct_flux, flux_texel(cell, 1)).r, imageLoad(direct_flux, flux_texel(cell, 2)).r,
                      imageLoad(direct_flux, flux_texel(cell, 3)).r);
    }
    return units.flux * counts / max(decode_area(encoded_area), float(lit) * units.lit_area / (1.5 * units.lights));
}
