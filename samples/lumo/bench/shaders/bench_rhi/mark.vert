#include "bench_rhi/mark.glsl"

layout(std430, binding = 0) readonly buffer Corners { vec4 corners[]; };

void main() { gl_Position = vec4(corners[gl_VertexIndex].xy * push.scale + push.place, 0.5, 1.0); }
