// Irradiance of indirect light at every pixel of the G-buffer by rays through the finest voxels.
#define CAMERA 3
#include "common/camera.glsl"
const int gather_binding = 4;
#include "cones/gather.glsl"
#define BLOCK_MARKS 11
#include "cones/rays.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    int rays;       // a pixel
    int first_ray;  // of this dispatch, which adds its rays to those before
    int end_ray;
    int first_row;
} push;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D normal_roughness;
layout(binding = 2) uniform sampler2D geometric_normal_occlusion;
layout(binding = 10, rgba32f) LUMO_READ_WRITE uniform image2D irradiance;

// A group takes 8 x 8 pixels; those with the same place in the pattern, whose rays are nearly parallel, side by side.
ivec2 own_pixel() {
    int thread = int(gl_LocalInvocationIndex);
    ivec2 place = ivec2(thread >> 2 & 3, thread >> 4);
    return ivec2(gl_WorkGroupID.xy) * 8 + place + 4 * ivec2(thread & 1, thread >> 1 & 1) + ivec2(0, push.first_row);
}

void main() {
    ivec2 pixel = own_pixel();
    if (any(greaterThanEqual(pixel, imageSize(irradiance)))) return;

    vec3 gathered = vec3(0);
    float pixel_depth = texelFetch(depth, pixel, 0).r;
    vec3 geometric_normal = texelFetch(geometric_normal_occlusion, pixel, 0).xyz;
    // Unlit surfaces have no normal.
    if (pixel_depth < 1.0 && geometric_normal != vec3(0)) {
        vec3 world = world_from_pixel(vec2(pixel) + 0.5, pixel_depth);
        vec3 position = gather_position(world);
        geometric_normal = unit(geometric_normal);
        vec3 normal = unit(texelFetch(normal_roughness, pixel, 0).xyz);
        // What the eye sees is free toward the eye.
        vec3 start = ray_start(position, geometric_normal, direction_to_eye(world));
        uint turn = turn_of(uvec2(pixel));
        gathered = rays_irradiance(start, geometric_normal, normal, turn, push.first_ray, push.end_ray, push.rays);
        if (push.first_ray == 0) gathered += emitter_irradiance_by_rays(position, start, normal, turn);
    }
    if (push.first_ray > 0) gathered += imageLoad(irradiance, pixel).rgb;
    imageStore(irradiance, pixel, vec4(gathered, 1));
}
