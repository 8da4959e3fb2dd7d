#include "bench_rhi/mark.glsl"

layout(binding = 1) uniform sampler2D picture;
layout(location = 0) out vec4 color;

void main() { color = texelFetch(picture, ivec2(0), 0) * push.tint; }
