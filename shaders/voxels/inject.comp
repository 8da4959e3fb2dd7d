// Radiance that leaves each voxel's surfaces when analytic lights alone light them; 0 where there
// are none.
#define FLUX 2
#define BLOCKS 4
#include "voxels/reflect.glsl"
#include "voxels/own_cell.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    vec3 flux;             // FluxUnits
    float lit_area;
    float lights;
    float radiance_scale;  // stored = radiance * radiance_scale
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 3) writeonly uniform image3D radiance;  // times opacity; a: opacity

void main() {
    ivec3 cell = own_cell();
    if (cell.x < 0 || any(greaterThanEqual(cell, imageSize(radiance)))) return;

    vec4 surface = imageLoad(albedo, cell);
    FluxUnits units = FluxUnits(push.flux, push.lit_area, push.lights);
    vec3 leaving = surface.rgb / pi * direct_irradiance(units, cell, imageLoad(area, cell).r);
    // The area of an empty voxel is 0 too.
    imageStore(radiance, cell, surface.a > 0.0 ? vec4(leaving * push.radiance_scale, 1) * surface.a : vec4(0));
}
