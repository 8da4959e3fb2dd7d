// Radiance that leaves each voxel's surfaces when the sun lights them and they gather light from the other voxels:
// one more reflection than the volume that is gathered from holds.
#include "voxels/reflect.glsl"
const int gather_binding = 5;
#include "cones/gather.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    vec3 irradiance;          // SunOnVoxels
    float texel_voxel_faces;
    float radiance_scale;     // stored = radiance * radiance_scale
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, rgba8) readonly uniform image3D normal;
layout(binding = 3, r32ui) readonly uniform uimage3D lit_texels;
layout(binding = 4) writeonly uniform image3D radiance;  // times opacity; a: opacity

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(radiance).x)) return;

    vec4 surface = imageLoad(albedo, voxel);
    if (surface.a == 0.0) {
        imageStore(radiance, voxel, vec4(0));
        return;
    }
    SunOnVoxels sun = SunOnVoxels(push.irradiance, push.texel_voxel_faces);
    vec3 irradiance = sun_irradiance(sun, imageLoad(lit_texels, voxel).r, imageLoad(area, voxel).r);

    vec3 center = vec3(voxel) + 0.5;
    vec3 facing = imageLoad(normal, voxel).xyz * 2.0 - 1.0;
    float agreement = length(facing);
    // Where a voxel's surfaces face opposite ways the mean says nothing, and both sides count.
    if (agreement > 0.25) {
        irradiance += gather_irradiance(center, facing / agreement, facing / agreement);
    } else {
        irradiance += 0.5 * (gather_irradiance(center, vec3(0, 1, 0), vec3(0, 1, 0)) +
                             gather_irradiance(center, vec3(0, -1, 0), vec3(0, -1, 0)));
    }
    imageStore(radiance, voxel, vec4(surface.rgb / pi * irradiance * push.radiance_scale, 1) * surface.a);
}
