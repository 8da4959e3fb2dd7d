layout(location = 0) in vec2 uv;
layout(location = 1) flat in uint color_index;

layout(binding = 1) uniform sampler2D base_color;
layout(binding = 5) uniform sampler2DShadow shadow;
layout(binding = 2, r32ui) uniform uimage2D hits;

layout(location = 0) out vec4 color;
layout(location = 2) out uint index;

void main() {
    imageAtomicAdd(hits, ivec2(gl_FragCoord.xy), 1u);
    color = texture(base_color, uv) * texture(shadow, vec3(uv, 0.5));
    index = color_index;
}
