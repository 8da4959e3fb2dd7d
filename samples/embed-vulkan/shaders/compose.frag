#version 450
#extension GL_GOOGLE_include_directive : require
#include "boxes.glsl"

layout(set = 0, binding = 1) uniform sampler2D albedo;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(set = 0, binding = 3) uniform sampler2D depth;
layout(set = 0, binding = 4) uniform sampler2D irradiance;
layout(location = 0) out vec4 color;

// The host's own shadows: a ray to the sun against every box.
bool sees_sun(vec3 position) {
    bool seen = true;
    for (int i = 0; i < box_count; ++i) {
        vec3 a = (boxes[i].center.xyz - boxes[i].half_size.xyz - position) / frame.toward_sun.xyz;
        vec3 b = (boxes[i].center.xyz + boxes[i].half_size.xyz - position) / frame.toward_sun.xyz;
        vec3 enter = min(a, b), leave = max(a, b);
        float first = max(max(enter.x, enter.y), max(enter.z, 0.0));
        seen = seen && first > min(min(leave.x, leave.y), leave.z);
    }
    return seen;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float z = texelFetch(depth, pixel, 0).r;
    vec3 radiance = frame.sky.rgb;
    if (z < 1.0) {
        vec2 ndc = gl_FragCoord.xy / vec2(textureSize(depth, 0)) * 2.0 - 1.0;
        vec4 homogeneous = frame.matrix * vec4(ndc, z, 1);
        vec3 n = texelFetch(normal, pixel, 0).xyz;
        vec3 position = homogeneous.xyz / homogeneous.w + n * 0.003;
        vec3 light = sees_sun(position) ? frame.sun.rgb * max(dot(n, frame.toward_sun.xyz), 0.0) : vec3(0);
        if (frame.toward_sun.w > 0.5) light += texelFetch(irradiance, pixel, 0).rgb;
        radiance = texelFetch(albedo, pixel, 0).rgb * light / 3.14159265;
    }
    color = vec4(1.0 - exp(-radiance), 1);
}
