// Irradiance of indirect light at every pixel of the G-buffer; or the ambient occlusion there, with gather_occlusion.
#define CAMERA 3
#include "common/camera.glsl"
const int gather_binding = 4;
#include "cones/gather.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D normal_roughness;
layout(binding = 2) uniform sampler2D geometric_normal_occlusion;
layout(binding = 10, rgba32f) writeonly uniform image2D irradiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(irradiance)))) return;

    vec3 gathered = vec3(0);
    float pixel_depth = texelFetch(depth, pixel, 0).r;
    vec3 geometric_normal = texelFetch(geometric_normal_occlusion, pixel, 0).xyz;
    // Unlit surfaces have no normal.
    if (pixel_depth < 1.0 && geometric_normal != vec3(0)) {
        gathered = gather_irradiance(gather_position(world_from_pixel(vec2(pixel) + 0.5, pixel_depth)),
                                     geometric_normal,
                                     unit(texelFetch(normal_roughness, pixel, 0).xyz), turn_of(uvec2(pixel)));
        if (gather_occlusion) gathered = max(1.0 - gathered / pi, 0.0);
    }
    imageStore(irradiance, pixel, vec4(gathered, 1));
}
