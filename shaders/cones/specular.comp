// Indirect light toward the eye that the specular lobe reflects, at every pixel of the G-buffer: one cone about the
// mirror direction, as wide as the lobe (docs/cones.md derives it), and the lobe's whole reflectance.
#define CAMERA 4
#include "common/brdf.glsl"
#include "common/camera.glsl"
const int gather_binding = 8;
#include "cones/gather.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D base_color_metallic;
layout(binding = 2) uniform sampler2D normal_roughness;
layout(binding = 3) uniform sampler2D geometric_normal_occlusion;
layout(binding = 5) uniform sampler2D irradiance;
layout(binding = 6) uniform sampler2D reflectance;  // by n·v and roughness: F0's factor, and what is added
layout(binding = 7, rgba32f) writeonly uniform image2D specular;

// A lobe's cone holds this part of its half vectors.
const float held = 0.75;
// The widest cone, 45 degrees to each side, by the tangent of half of that. What a wider lobe has beyond it sees the
// hemisphere's mean.
const float widest_tangent = 0.41421356;

vec3 reflected(Surface surface, vec3 position, vec3 geometric_normal, vec3 normal, vec3 to_eye, vec3 irradiance) {
    // Of GGX, tan² <= t² / (a² + t²) of the half vectors have a slope of at most t; directions turn twice as far.
    float alpha = surface.roughness * surface.roughness;
    float slope = min(sqrt(held / (1.0 - held)) * alpha, widest_tangent);
    float in_cone = min(slope * slope / (alpha * alpha + slope * slope) / held, 1.0);
    // Of the half-angle, twice that of the slope; without trigonometry, in which the APIs differ.
    float squared = slope * slope;
    float tangent = 2.0 * slope / (1.0 - squared);
    float sine = 2.0 * slope / (1.0 + squared);
    float cosine = (1.0 - squared) / (1.0 + squared);

    // Of a lobe that the horizon cuts, the middle of what lies above: of the axis and the lobe's width of elevation.
    vec3 axis = reflect(-to_eye, normal);
    float height = dot(axis, geometric_normal);
    if (height < sine) {
        vec3 level = axis - geometric_normal * height;
        vec3 along = level * inversesqrt(max(dot(level, level), 1e-12));
        axis = unit(axis + along * cosine + geometric_normal * (sine + 1e-3));
        float above = max(dot(axis, geometric_normal), 0.02);
        tangent = min(tangent, above * inversesqrt(max(1.0 - above * above, 1e-6)));
    }
    vec3 radiance = trace_cone(position + geometric_normal, axis, tangent, 1.0, 1.0, -1.0);
    float texels = float(textureSize(reflectance, 0).x);
    vec2 place = vec2(dot(normal, to_eye), surface.roughness) * ((texels - 1.0) / texels) + 0.5 / texels;
    vec2 factors = texture(reflectance, place).xy;
    return mix(irradiance / pi, radiance, in_cone) * (surface.specular * factors.x + factors.y);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(specular)))) return;

    vec3 light = vec3(0);
    float pixel_depth = texelFetch(depth, pixel, 0).r;
    vec4 stored_normal = texelFetch(normal_roughness, pixel, 0);
    // Unlit surfaces have no normal.
    if (pixel_depth < 1.0 && stored_normal.xyz != vec3(0)) {
        vec4 base_color = texelFetch(base_color_metallic, pixel, 0);
        vec3 position = world_from_pixel(vec2(pixel) + 0.5, pixel_depth);
        light = reflected(make_surface(base_color.rgb, base_color.a, stored_normal.w), gather_position(position),
                          unit(texelFetch(geometric_normal_occlusion, pixel, 0).xyz), unit(stored_normal.xyz),
                          direction_to_eye(position), texelFetch(irradiance, pixel, 0).rgb);
    }
    imageStore(specular, pixel, vec4(light, 1));
}
