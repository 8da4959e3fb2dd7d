// A translucent surface, shaded where it is drawn: what it reflects and emits, seen through the air of a sky, and its
// opacity. The vertex stage is the G-buffer's.
#include "gbuffer/interface.glsl"
#define EMISSION_TEXTURE 8
#define LIGHTS 9
#define SHADOW_MAPS 10
#include "common/material.glsl"
#include "lighting/direct.glsl"
#define SKY 24
const int atmosphere_binding = 20;
#include "atmosphere/sky.glsl"
#include "sky/view.glsl"
#include "sky/before.glsl"
#ifdef INDIRECT
const int gather_binding = 11;
#include "cones/gather.glsl"
#endif

layout(constant_id = 0) const bool analytic_lights = false;
layout(constant_id = 1) const bool diffuse_materials = false;
layout(constant_id = 2) const bool air_before = false;
layout(constant_id = 3) const bool air_in_parts = false;  // these wavelengths' share of what is seen

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec4 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in float in_handedness;

layout(location = 0) out vec4 out_radiance;  // not premultiplied

// Toward the eye, where the surface is.
vec3 leaving(vec3 position, vec3 base_color) {
    vec2 uv0 = in_uv.xy;
    vec2 uv1 = in_uv.zw;
    vec2 metallic_roughness = vec2(0, 1);
    float occlusion = 1;
    if (!diffuse_materials) {
        metallic_roughness = material_metallic_roughness(uv0, uv1);
        occlusion = material_occlusion(uv0, uv1);
    }
    float side = gl_FrontFacing == (in_handedness > 0) ? 1 : -1;
    vec3 geometric_normal = side * unit(in_normal + vec3(0, 1e-12, 0));
    vec3 normal = side * material_normal(uv0, uv1, in_normal, in_tangent);
    Surface surface = make_surface(base_color, metallic_roughness.x, metallic_roughness.y);

    vec3 radiance = material_emission(uv0, uv1);
    if (analytic_lights)
        radiance += reflect_lights(surface, position, geometric_normal, normal, diffuse_materials);
#ifdef INDIRECT
    radiance += surface.diffuse / pi * occlusion *
                gather_irradiance(gather_position(position), geometric_normal, normal, turn_of(uvec2(gl_FragCoord.xy)));
#endif
    return radiance;
}

void main() {
    vec4 base_color = material_base_color(in_uv.xy, in_uv.zw, in_color);
    vec3 position = world_from_pixel(gl_FragCoord.xy, gl_FragCoord.z);
    vec3 radiance = base_color.rgb;
    if (!is_unlit()) radiance = leaving(position, base_color.rgb);
    if (air_before) {
        AirBefore seen = air_before_surface(position, gl_FragCoord.xy);
        vec3 through = rgb_of_transmittance(seen.transmittance);
        vec3 added = rgb_of(seen.radiance);
        // As of opaque surfaces; the shares of some wavelengths may lie beyond these bounds.
        if (!air_in_parts) {
            through = clamp(through, 0.0, 1.0);
            added = max(added, vec3(0));
        }
        radiance = through * radiance + added;
    }
    out_radiance = vec4(radiance, base_color.a);
}
