// Depth with the world position beside it, as the paper injects light. w is 1 where something was drawn.
#include "shadow/interface.glsl"
#include "common/material.glsl"

layout(constant_id = 0) const bool alpha_test = false;

layout(location = 0) in vec4 in_uv;
layout(location = 1) in float in_alpha;
layout(location = 2) in vec3 in_position;

layout(location = 0) out vec4 out_position;

void main() {
    if (alpha_test) {
        vec4 color = material_base_color(in_uv.xy, in_uv.zw, vec4(1, 1, 1, in_alpha));
        if (color.a < material.alpha_cutoff) discard;
    }
    out_position = vec4(in_position, 1);
}
