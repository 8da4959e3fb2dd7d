#include "shadow/interface.glsl"
#include "common/material.glsl"

layout(location = 0) in vec4 in_uv;
layout(location = 1) in float in_alpha;
layout(location = 2) in vec3 in_position;

void main() {
    vec4 color = material_base_color(in_uv.xy, in_uv.zw, vec4(1, 1, 1, in_alpha));
    if (color.a < material.alpha_cutoff) discard;
}
