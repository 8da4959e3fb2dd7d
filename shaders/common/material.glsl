// A metallic-roughness material of glTF, as scene::GpuScene lays it out. The includer defines MATERIAL, the binding of
// its block, and those of the textures that it reads: BASE_COLOR_TEXTURE, METALLIC_ROUGHNESS_TEXTURE, NORMAL_TEXTURE,
// OCCLUSION_TEXTURE, EMISSION_TEXTURE. A material without one of them has a neutral 1x1 texture.
//
// A uniform block per draw, not an array in a storage buffer: llvmpipe reads zeros from storage buffers in helper
// invocations, so that derivatives of texture coordinates would be wrong at the edges of triangles.
//
// Functions that end in _lod name the mip level; the others take it from derivatives, in fragment shaders only.
#include "common/transform.glsl"

const uint role_base_color = 0u;
const uint role_metallic_roughness = 1u;
const uint role_normal = 2u;
const uint role_occlusion = 3u;
const uint role_emission = 4u;

// Of material.flags. Bits 0 to 4 say that a role's texture has the second set of coordinates.
const uint material_unlit = 0x100u;
const uint material_normal_mapped = 0x200u;

layout(std140, binding = MATERIAL) uniform Material {
    vec4 base_color;     // linear
    vec3 emission;       // radiance, W/m²/sr
    float alpha_cutoff;  // of MASK; 0 otherwise
    float metallic;
    float roughness;     // perceptual
    float normal_scale;
    float occlusion_strength;
    uint flags;
    vec4 uv_rows[10];    // per role, the two rows of the affine map of its texture coordinates
} material;

bool is_unlit() { return (material.flags & material_unlit) != 0u; }

vec2 texture_uv(uint role, vec2 uv0, vec2 uv1) {
    vec3 uv = vec3((material.flags >> role & 1u) != 0u ? uv1 : uv0, 1);
    return vec2(dot(material.uv_rows[2u * role].xyz, uv),
                dot(material.uv_rows[2u * role + 1u].xyz, uv));
}

#ifdef BASE_COLOR_TEXTURE
layout(binding = BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;

// Linear colour and opacity; `color` is the vertex's.
vec4 material_base_color(vec2 uv0, vec2 uv1, vec4 color) {
    return material.base_color * color *
           texture(base_color_texture, texture_uv(role_base_color, uv0, uv1));
}
vec4 material_base_color_lod(vec2 uv0, vec2 uv1, vec4 color, float lod) {
    return material.base_color * color *
           textureLod(base_color_texture, texture_uv(role_base_color, uv0, uv1), lod);
}
#endif

#ifdef METALLIC_ROUGHNESS_TEXTURE
layout(binding = METALLIC_ROUGHNESS_TEXTURE) uniform sampler2D metallic_roughness_texture;

// x: metallic, y: perceptual roughness.
vec2 material_metallic_roughness(vec2 uv0, vec2 uv1) {
    return vec2(material.metallic, material.roughness) *
           texture(metallic_roughness_texture, texture_uv(role_metallic_roughness, uv0, uv1)).bg;
}
#endif

#ifdef NORMAL_TEXTURE
layout(binding = NORMAL_TEXTURE) uniform sampler2D normal_texture;

// World-space shading normal in the convention of MikkTSpace (Mikkelsen 2008): the frame is made of the
// interpolants as they are, not renormalised. `tangent.w` includes the instance's handedness. Unit length; the
// blue channel is kept above 0, so that no texel can turn the normal into the surface or make it vanish.
vec3 material_normal(vec2 uv0, vec2 uv1, vec3 normal, vec4 tangent) {
    if ((material.flags & material_normal_mapped) == 0u) return unit(normal);
    vec3 t = 2 * texture(normal_texture, texture_uv(role_normal, uv0, uv1)).xyz - 1;
    t = vec3(t.xy * material.normal_scale, max(t.z, 1e-2));
    vec3 bitangent = tangent.w * cross(normal, tangent.xyz);
    return unit(t.x * tangent.xyz + t.y * bitangent + t.z * normal);
}
#endif

#ifdef OCCLUSION_TEXTURE
layout(binding = OCCLUSION_TEXTURE) uniform sampler2D occlusion_texture;

// 1 is open.
float material_occlusion(vec2 uv0, vec2 uv1) {
    float texel = texture(occlusion_texture, texture_uv(role_occlusion, uv0, uv1)).r;
    return 1 + material.occlusion_strength * (texel - 1);
}
#endif

#ifdef EMISSION_TEXTURE
layout(binding = EMISSION_TEXTURE) uniform sampler2D emission_texture;

// Radiance, W/m²/sr.
vec3 material_emission(vec2 uv0, vec2 uv1) {
    return material.emission *
           texture(emission_texture, texture_uv(role_emission, uv0, uv1)).rgb;
}
vec3 material_emission_lod(vec2 uv0, vec2 uv1, float lod) {
    return material.emission *
           textureLod(emission_texture, texture_uv(role_emission, uv0, uv1), lod).rgb;
}
#endif
