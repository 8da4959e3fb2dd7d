// Radiance that leaves each voxel's surfaces when the sun alone lights them.
#include "voxels/reflect.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    vec3 irradiance;          // SunOnVoxels
    float texel_voxel_faces;
    float radiance_scale;     // stored = radiance * radiance_scale
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, r32ui) readonly uniform uimage3D lit_texels;
layout(binding = 3) writeonly uniform image3D radiance;  // times opacity; a: opacity

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(radiance).x)) return;

    vec4 surface = imageLoad(albedo, voxel);
    vec3 leaving = vec3(0);
    if (surface.a > 0.0) {
        SunOnVoxels sun = SunOnVoxels(push.irradiance, push.texel_voxel_faces);
        leaving = surface.rgb / pi *
                  sun_irradiance(sun, imageLoad(lit_texels, voxel).r, imageLoad(area, voxel).r);
    }
    imageStore(radiance, voxel, vec4(leaving * push.radiance_scale, 1) * surface.a);
}
