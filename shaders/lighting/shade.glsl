// Radiance toward the eye at every pixel of the G-buffer: reflected light of the analytic lights, indirect light
// reflected by the diffuse lobe and by the specular one, emission, and the environment where nothing is; through the air
// of a sky.
#define CAMERA 7
#define SHADOW_MAPS 6
#define LIGHTS 8
#include "lighting/direct.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool analytic_lights = false;
layout(constant_id = 1) const bool indirect_light = false;
layout(constant_id = 2) const bool emission = false;
layout(constant_id = 3) const bool diffuse_materials = false;
layout(constant_id = 4) const bool specular_light = false;
layout(constant_id = 5) const bool sky = false;

layout(push_constant) uniform Push {
    vec3 environment;  // radiance from outside the scene, W/m²/sr
} push;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D base_color_metallic;
layout(binding = 2) uniform sampler2D normal_roughness;
layout(binding = 3) uniform sampler2D geometric_normal_occlusion;
layout(binding = 4) uniform sampler2D emission_target;
layout(binding = 5) uniform sampler2D irradiance;
layout(binding = 9, rgba32f) writeonly uniform image2D out_radiance;
#ifdef LAYERS
layout(binding = 10, rgba32f) writeonly uniform image2D out_direct;
layout(binding = 11, rgba32f) writeonly uniform image2D out_indirect;
#endif
layout(binding = 12) uniform sampler2D specular_target;
layout(binding = 13) uniform sampler2D sky_radiance;       // as lumo::sky::Pixels
layout(binding = 14) uniform sampler2D sky_transmittance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(out_radiance)))) return;

    float pixel_depth = texelFetch(depth, pixel, 0).x;
    vec3 direct = vec3(0);
    vec3 indirect = vec3(0);
    vec3 specular = vec3(0);
    vec3 unreflected = vec3(0);
    if (pixel_depth == 1) {
        unreflected = push.environment;
    } else {
        vec4 stored_normal = texelFetch(normal_roughness, pixel, 0);
        if (emission) unreflected = texelFetch(emission_target, pixel, 0).rgb;
        // Unlit surfaces have no normal.
        if (stored_normal.xyz != vec3(0)) {
            vec4 base_color = texelFetch(base_color_metallic, pixel, 0);
            vec4 geometric = texelFetch(geometric_normal_occlusion, pixel, 0);
            vec3 normal = unit(stored_normal.xyz);
            Surface surface = make_surface(base_color.rgb, base_color.a, stored_normal.w);
            if (analytic_lights) {
                vec3 position = world_from_pixel(vec2(pixel) + 0.5, pixel_depth);
                direct = reflect_lights(surface, position, unit(geometric.xyz), normal, diffuse_materials);
            }
            if (indirect_light)
                indirect = surface.diffuse / pi * geometric.w * texelFetch(irradiance, pixel, 0).rgb;
            if (specular_light) specular = texelFetch(specular_target, pixel, 0).rgb;
        }
    }
    vec3 radiance = direct + indirect + specular + unreflected;
    if (sky) {
        vec3 through = clamp(texelFetch(sky_transmittance, pixel, 0).rgb, 0.0, 1.0);
        radiance = through * radiance + max(texelFetch(sky_radiance, pixel, 0).rgb, 0.0);
    }
    imageStore(out_radiance, pixel, vec4(radiance, 1));
#ifdef LAYERS
    imageStore(out_direct, pixel, vec4(direct, 1));
    imageStore(out_indirect, pixel, vec4(indirect, 1));
#endif
}
