// The camera of a frame. The includer defines CAMERA, the block's binding. Filled by lumo::gbuffer::camera_block.
// Pixel (0, 0) is memory row 0, which is NDC (-1, -1).
#include "common/transform.glsl"

layout(std140, binding = CAMERA) uniform Camera {
    mat4 clip_from_world;
    mat4 world_from_clip;
    vec4 eye;           // homogeneous: the position and 1, or the direction to an orthographic camera and 0
    vec2 inverse_size;  // 1 / pixels
} camera;

// The world position seen at `pixel` (centres are at .5) with `depth` in [0, 1].
vec3 world_from_pixel(vec2 pixel, float depth) {
    vec4 p = transform(camera.world_from_clip, vec4(2 * pixel * camera.inverse_size - 1, depth, 1));
    return p.xyz * (1 / p.w);
}

// Toward the eye, unit length.
vec3 direction_to_eye(vec3 position) { return unit(camera.eye.xyz - camera.eye.w * position); }
