// Evaluates shaders/common/brdf.glsl, one case an invocation.
#include "common/brdf.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 0) const bool lambert = false;

layout(push_constant) uniform Push {
    uint count;
} push;

struct Case {
    vec4 base_color_metallic;
    vec4 to_eye_roughness;
    vec4 to_light;
};

layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) writeonly buffer Results { vec4 results[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    Case c = cases[i];
    Surface surface = make_surface(c.base_color_metallic.rgb, c.base_color_metallic.a, c.to_eye_roughness.w);
    results[i] = vec4(reflect_direct(surface, vec3(0, 0, 1), c.to_eye_roughness.xyz, c.to_light.xyz, lambert), 0);
}
