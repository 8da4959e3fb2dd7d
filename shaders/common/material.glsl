// glTF's metallic-roughness materials, as scene::GpuScene lays them out. The includer defines MATERIALS, the binding
// of the buffer, and those of the textures that it reads: BASE_COLOR_TEXTURE, METALLIC_ROUGHNESS_TEXTURE,
// NORMAL_TEXTURE, OCCLUSION_TEXTURE, EMISSION_TEXTURE. A material without one of them has a neutral 1x1 texture.
//
// Functions that end in _lod name the mip level; the others take it from derivatives, in fragment shaders only.
#include "common/transform.glsl"

const uint role_base_color = 0u;
const uint role_metallic_roughness = 1u;
const uint role_normal = 2u;
const uint role_occlusion = 3u;
const uint role_emission = 4u;

// Of Material::flags. Bits 0 to 4 say that a role's texture has the second set of coordinates.
const uint material_unlit = 0x100u;
const uint material_normal_mapped = 0x200u;

struct Material {
    vec4 base_color;     // linear
    vec3 emission;       // radiance, W/m²/sr
    float alpha_cutoff;  // of MASK; 0 otherwise
    float metallic;
    float roughness;     // perceptual
    float normal_scale;
    float occlusion_strength;
    uint flags;
    uint pad0;
    uint pad1;
    uint pad2;
    vec4 uv_rows[10];    // per role, the two rows of the affine map of its texture coordinates
};

layout(std430, binding = MATERIALS) readonly buffer Materials {
    Material data[];
} materials;

bool is_unlit(uint material) { return (materials.data[material].flags & material_unlit) != 0u; }

vec2 texture_uv(uint material, uint role, vec2 uv0, vec2 uv1) {
    vec3 uv = vec3((materials.data[material].flags >> role & 1u) != 0u ? uv1 : uv0, 1);
    return vec2(dot(materials.data[material].uv_rows[2u * role].xyz, uv),
                dot(materials.data[material].uv_rows[2u * role + 1u].xyz, uv));
}

#ifdef BASE_COLOR_TEXTURE
layout(binding = BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;

// Linear colour and opacity; `color` is the vertex's.
vec4 material_base_color(uint material, vec2 uv0, vec2 uv1, vec4 color) {
    return materials.data[material].base_color * color *
           texture(base_color_texture, texture_uv(material, role_base_color, uv0, uv1));
}
vec4 material_base_color_lod(uint material, vec2 uv0, vec2 uv1, vec4 color, float lod) {
    return materials.data[material].base_color * color *
           textureLod(base_color_texture, texture_uv(material, role_base_color, uv0, uv1), lod);
}
#endif

#ifdef METALLIC_ROUGHNESS_TEXTURE
layout(binding = METALLIC_ROUGHNESS_TEXTURE) uniform sampler2D metallic_roughness_texture;

// x: metallic, y: perceptual roughness.
vec2 material_metallic_roughness(uint material, vec2 uv0, vec2 uv1) {
    return vec2(materials.data[material].metallic, materials.data[material].roughness) *
           texture(metallic_roughness_texture, texture_uv(material, role_metallic_roughness, uv0, uv1)).bg;
}
#endif

#ifdef NORMAL_TEXTURE
layout(binding = NORMAL_TEXTURE) uniform sampler2D normal_texture;

// World-space shading normal in the convention of MikkTSpace (Mikkelsen 2008): the frame is made of the
// interpolants as they are, not renormalised. `tangent.w` includes the instance's handedness. Unit length; the
// blue channel is kept above 0, so that no texel can turn the normal into the surface or make it vanish. `material` is uniform in a draw.
vec3 material_normal(uint material, vec2 uv0, vec2 uv1, vec3 normal, vec4 tangent) {
    if ((materials.data[material].flags & material_normal_mapped) == 0u) return unit(normal);
    vec3 t = 2 * texture(normal_texture, texture_uv(material, role_normal, uv0, uv1)).xyz - 1;
    t = vec3(t.xy * materials.data[material].normal_scale, max(t.z, 1e-2));
    vec3 bitangent = tangent.w * cross(normal, tangent.xyz);
    return unit(t.x * tangent.xyz + t.y * bitangent + t.z * normal);
}
#endif

#ifdef OCCLUSION_TEXTURE
layout(binding = OCCLUSION_TEXTURE) uniform sampler2D occlusion_texture;

// 1 is open.
float material_occlusion(uint material, vec2 uv0, vec2 uv1) {
    float texel = texture(occlusion_texture, texture_uv(material, role_occlusion, uv0, uv1)).r;
    return 1 + materials.data[material].occlusion_strength * (texel - 1);
}
#endif

#ifdef EMISSION_TEXTURE
layout(binding = EMISSION_TEXTURE) uniform sampler2D emission_texture;

// Radiance, W/m²/sr.
vec3 material_emission(uint material, vec2 uv0, vec2 uv1) {
    return materials.data[material].emission *
           texture(emission_texture, texture_uv(material, role_emission, uv0, uv1)).rgb;
}
vec3 material_emission_lod(uint material, vec2 uv0, vec2 uv1, float lod) {
    return materials.data[material].emission *
           textureLod(emission_texture, texture_uv(material, role_emission, uv0, uv1), lod).rgb;
}
#endif
