#include "gbuffer/interface.glsl"
#include "common/material.glsl"

layout(constant_id = 0) const bool alpha_test = false;
layout(constant_id = 1) const bool normal_mapping = false;
layout(constant_id = 2) const bool diffuse_materials = false;

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec4 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in float in_handedness;

layout(location = 0) out vec4 out_base_color_metallic;
layout(location = 1) out vec4 out_normal_roughness;
layout(location = 2) out vec4 out_geometric_normal_occlusion;
#ifdef EMISSION_TEXTURE
layout(location = 3) out vec4 out_emission;
#endif

void main() {
    vec2 uv0 = in_uv.xy;
    vec2 uv1 = in_uv.zw;
    vec4 base_color = material_base_color(uv0, uv1, in_color);
    // Derivatives are undefined after a discard, so that every texture is read before it.
    vec2 metallic_roughness = vec2(0, 1);
    float occlusion = 1;
    if (!diffuse_materials) {
        metallic_roughness = material_metallic_roughness(uv0, uv1);
        occlusion = material_occlusion(uv0, uv1);
    }
    // Interpolants of opposite normals can cancel; the small term keeps a direction then.
    vec3 geometric_normal = unit(in_normal + vec3(0, 1e-12, 0));
    vec3 normal = geometric_normal;
    if (normal_mapping) normal = material_normal(uv0, uv1, in_normal, in_tangent);
#ifdef EMISSION_TEXTURE
    vec3 emission = material_emission(uv0, uv1);
#endif
    if (alpha_test && base_color.a < material.alpha_cutoff) discard;

    // A mirrored instance swaps the faces that the rasterizer calls front and back.
    float side = gl_FrontFacing == (in_handedness > 0) ? 1 : -1;
    out_base_color_metallic = vec4(base_color.rgb, metallic_roughness.x);
    out_normal_roughness = vec4(side * normal, metallic_roughness.y);
    out_geometric_normal_occlusion = vec4(side * geometric_normal, occlusion);
#ifdef EMISSION_TEXTURE
    // Without a normal nothing lights the pixel; its colour goes out as it is.
    if (is_unlit()) {
        out_normal_roughness.xyz = vec3(0);
        out_geometric_normal_occlusion.xyz = vec3(0);
        emission = base_color.rgb;
    }
    out_emission = vec4(emission, 1);
#endif
}
