// The camera of a frame. The includer defines CAMERA, the block's binding. Filled by lumo::gbuffer::camera_block.
// Pixel (0, 0) is memory row 0, which is NDC (-1, -1).
#include "common/transform.glsl"

layout(std140, binding = CAMERA) uniform Camera {
    mat4 clip_from_offset;
    vec4 eye;           // homogeneous: the position and 1, or the direction to an orthographic camera and 0
    // Perspective: the ray through pixel coordinates (x, y), one unit long along the camera's axis, is
    // corner + x across + y along from the eye. Orthographic: the same sum is where the ray starts.
    vec3 corner;
    float depth_offset;  // of what world_from_pixel makes of depth
    vec3 across;
    float depth_scale;
    vec3 along;
} camera;

// From the offset to the eye, which loses nothing near it, instead of from the position: a matrix that subtracts the
// eye rounds z and w apart, and depth magnifies the difference by the distance over the near plane's.
vec4 clip_from_world(vec3 position) {
    return transform(camera.clip_from_offset, vec4(position - camera.eye.xyz * camera.eye.w, 1));
}

// The world position seen at `pixel` (centres are at .5) with `depth` in [0, 1].
//
// 1 - depth is exact where depth is above 1/2, and the reciprocal distance (perspective) or the distance itself
// (orthographic) is linear in it. A product with an inverse matrix would instead subtract terms as large as the
// camera's position over the near plane's distance.
vec3 world_from_pixel(vec2 pixel, float depth) {
    precise vec3 ray = (camera.corner + camera.across * pixel.x) + camera.along * pixel.y;
    precise float linear = camera.depth_offset + camera.depth_scale * (1 - depth);
    precise vec3 seen = camera.eye.xyz + ray * (1 / linear);
    precise vec3 orthographic = ray - camera.eye.xyz * linear;
    return camera.eye.w > 0 ? seen : orthographic;
}

// Toward the eye, unit length.
vec3 direction_to_eye(vec3 position) { return unit(camera.eye.xyz - camera.eye.w * position); }
