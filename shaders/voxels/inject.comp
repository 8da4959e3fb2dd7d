// Radiance that leaves each voxel's surfaces after the sun's light struck them.
//
// The flux from the sun, texels * texel area * irradiance, is reflected diffusely over all of the voxel's surface:
// radiance = albedo / pi * flux / area.
#include "common/constants.glsl"
#include "common/voxel_grid.glsl"

layout(local_size_x = 8, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push {
    vec3 irradiance;          // on a plane facing the sun, W/m²
    float texel_voxel_faces;  // a shadow texel's area on that plane, in voxel faces
    float radiance_scale;     // stored = radiance * radiance_scale, for 0 to 1
} push;

layout(binding = 0, rgba8) readonly uniform image3D albedo;
layout(binding = 1, r8) readonly uniform image3D area;
layout(binding = 2, r32ui) readonly uniform uimage3D lit_texels;
layout(binding = 3, rgba8) writeonly uniform image3D radiance;  // times opacity; a: opacity

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (!inside_grid(voxel, imageSize(radiance).x)) return;

    vec4 surface = imageLoad(albedo, voxel);
    vec3 leaving = vec3(0);
    if (surface.a > 0.0) {
        float texels = float(imageLoad(lit_texels, voxel).r);
        float faces = decode_area(imageLoad(area, voxel).r);
        // The mean cosine; above 1 only where the area was underestimated.
        float cosine = min(texels * push.texel_voxel_faces / faces, 1.0);
        leaving = surface.rgb / pi * push.irradiance * cosine;
    }
    imageStore(radiance, voxel, vec4(leaving * push.radiance_scale, 1.0) * surface.a);
}
