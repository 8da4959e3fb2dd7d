// Sample push.index of every texel.
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Push { uvec2 size; int index; } push;
layout(binding = 0) uniform sampler2DMS source;
layout(std430, binding = 1) writeonly buffer Results { vec4 results[]; };

void main() {
    uvec2 p = gl_GlobalInvocationID.xy;
    if (p.x < push.size.x && p.y < push.size.y)
        results[p.y * push.size.x + p.x] = texelFetch(source, ivec2(p), push.index);
}
