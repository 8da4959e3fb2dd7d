// Light that leaves a voxel's surfaces, diffusely reflected.
#include "common/constants.glsl"
#include "common/voxel_grid.glsl"

// The sun's light on a voxel.
struct SunOnVoxels {
    vec3 irradiance;          // on a plane facing the sun, W/m²
    float texel_voxel_faces;  // a shadow texel's area on that plane, in voxel faces
};

// Mean irradiance over a voxel's surfaces, W/m²: the flux of the shadow texels counted in it, over its area. The area is
// counted too, up to about a third too small, so the ratio is not cut at 1, which would lose flux; far beyond 1 it is
// no more than a sliver's area badly estimated.
vec3 sun_irradiance(SunOnVoxels sun, uint lit_texels, float encoded_area) {
    return sun.irradiance * min(float(lit_texels) * sun.texel_voxel_faces / decode_area(encoded_area), 1.5);
}
