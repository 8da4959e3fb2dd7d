// Indirect light toward the eye that the specular lobe reflects, at every pixel of the G-buffer: cones along the
// lobe, as wide as their parts of it (docs/cones.md derives them), and the lobe's whole reflectance.
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

// The cone of a narrow lobe holds this part of its half vectors.
const float held = 0.75;
// A lobe that is wider than this, by its alpha, of a surface that reflects more than this, has several cones.
const float split_alpha = 0.03;
const float split_reflectance = 0.15;
const int split_cones = 12;
// The golden angle, by which they follow each other about the normal: cosine and sine.
const vec2 golden = vec2(-0.73736888, 0.67549029);
// The widest cone, 45 degrees to each side: its tangent, and that of half of it.
const float widest_tangent = 1.0;
const float widest_slope = 0.41421356;
// How far above a surface its own voxels and the filter reach, in voxels.
const float clearance = 1.5;
const float farthest_start = 8.0;  // voxels
// A cone as narrow as this, by its tangent, starts on its axis, so that what it meets is not displaced; wider ones, which
// would see their own surface, from above it.
const float narrow_tangent = 0.15;

vec3 leaving_cone(vec3 position, vec3 geometric_normal, vec3 direction, float tangent) {
    float height = max(dot(direction, geometric_normal), 0.02);
    // What of it lies below the horizon is left out.
    float held_tangent = min(tangent, height * inversesqrt(max(1.0 - height * height, 1e-6)));
    bool narrow = held_tangent < narrow_tangent;
    float start = narrow ? min(clearance / height, farthest_start) : 1.0;
    float lift = narrow ? max(clearance - start * height, 0.0) : 1.0;
    vec3 origin = position + lift * geometric_normal;
    vec3 radiance = trace_cone(origin, direction, held_tangent, start, 0.0);
    if (gather_emission) radiance += trace_emission(origin, direction, held_tangent, start, 0.0);
    return radiance;
}

// Of a cone by its solid angle, in sr.
float tangent_of(float solid_angle) {
    float cosine = max(1.0 - solid_angle / (2.0 * pi), 0.5);
    return min(sqrt(1.0 - cosine * cosine) / cosine, widest_tangent);
}

// Of a cone that the horizon cuts, the middle of what lies above: of the axis and the cone's width of elevation. `slope`:
// the tangent of a quarter of its angle.
vec3 middle_above(vec3 axis, vec3 geometric_normal, float slope) {
    float squared = slope * slope;
    float sine = 2.0 * slope / (1.0 + squared);
    float cosine = (1.0 - squared) / (1.0 + squared);
    float height = dot(axis, geometric_normal);
    if (height >= sine) return axis;
    vec3 level = axis - geometric_normal * height;
    vec3 along = level * inversesqrt(max(dot(level, level), 1e-12));
    return unit(axis + along * cosine + geometric_normal * (sine + 1e-3));
}

// Radiance that the lobe sees: the mean over its cones, weighted with what the lobe reflects of each. `turn`: as turn_of.
vec3 lobe_radiance(Surface surface, vec3 position, vec3 geometric_normal, vec3 normal, vec3 to_eye, vec3 irradiance,
                   uint turn) {
    float alpha = surface.roughness * surface.roughness;
    bool split =
        alpha > split_alpha && max(surface.specular.r, max(surface.specular.g, surface.specular.b)) > split_reflectance;
    float k = (surface.roughness + 1.0) * (surface.roughness + 1.0) / 8.0;
    mat3 frame = frame_about(normal);
    // Of GGX, tan² <= a² u / (1 - u) of the half vectors have a part u of the probability. Directions turn twice as far;
    // without trigonometry, in which the APIs differ.
    float slope = min(sqrt(held / (1.0 - held)) * alpha, widest_slope);
    float tangent = 2.0 * slope / (1.0 - slope * slope);
    // What one cone does not hold of a wide lobe sees the hemisphere's mean.
    float in_cone = split ? 1.0 : min(slope * slope / (alpha * alpha + slope * slope) / held, 1.0);

    float angle = float(turn) * (2.0 * pi / 16.0);
    vec2 around = vec2(cos(angle), sin(angle));
    vec3 sum = vec3(0);
    float weights = 0.0;
    int count = split ? split_cones : 1;
    int i = 0;
    do {
        float part = split ? (float(i) + 0.5) / float(split_cones) : 0.0;
        float squared = alpha * alpha * part / (1.0 - part);
        float n_h = inversesqrt(1.0 + squared);
        vec3 half_vector = frame * (n_h * vec3(sqrt(squared) * around, 1.0));
        around = vec2(golden.x * around.x - golden.y * around.y, golden.y * around.x + golden.x * around.y);
        float v_h = dot(to_eye, half_vector);
        vec3 direction = 2.0 * v_h * half_vector - to_eye;
        if (split) {
            // As wide as its part of the probability is thin (Krivanek & Colbert 2008, Real-time Shading with Filtered
            // Importance Sampling).
            float d = (alpha * alpha - 1.0) * n_h * n_h + 1.0;
            float density = alpha * alpha / (pi * d * d) * n_h / (4.0 * max(v_h, 1e-3));
            tangent = tangent_of(1.0 / (float(split_cones) * density));
        } else {
            direction = middle_above(direction, geometric_normal, slope);
        }
        // The lobe over the density of half vectors. The first one counts where all others lie below the horizon too.
        float n_l = dot(normal, direction);
        bool above = dot(geometric_normal, direction) > 0.0 && v_h > 0.0 && n_l > 0.0;
        float weight = above ? n_l / (n_l * (1.0 - k) + k) * v_h / n_h : 0.0;
        if (i == 0) weight = max(weight, 1e-3);
        sum += weight * leaving_cone(position, geometric_normal, direction, tangent);
        weights += weight;
        ++i;
    } while (i < count);
    return mix(irradiance / pi, sum / weights, in_cone);
}

vec3 reflected(Surface surface, vec3 position, vec3 geometric_normal, vec3 normal, vec3 to_eye, vec3 irradiance,
               uint turn) {
    vec3 radiance = lobe_radiance(surface, position, geometric_normal, normal, to_eye, irradiance, turn);
    float texels = float(textureSize(reflectance, 0).x);
    vec2 place = vec2(dot(normal, to_eye), surface.roughness) * ((texels - 1.0) / texels) + 0.5 / texels;
    vec2 factors = texture(reflectance, place).xy;
    return radiance * (surface.specular * factors.x + factors.y);
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
                          direction_to_eye(position), texelFetch(irradiance, pixel, 0).rgb,
                          turn_of(uvec2(pixel)));
    }
    imageStore(specular, pixel, vec4(light, 1));
}
