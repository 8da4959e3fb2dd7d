// Analytic lights and what of each reaches a point, from its shadow maps. The includer defines LIGHTS, the block's
// binding, and SHADOW_MAPS, that of their depth. Filled by lumo::shadow::Shadow::record.
//
// A light has one camera: orthographic for a directional light, perspective for a spot light; or six, perspective,
// along +x, -x, +y, -y, +z, -z: for a point light and for a spot light too wide for one.
#include "common/transform.glsl"

const int max_lights = 32;
const int max_light_cameras = 64;

layout(std140, binding = LIGHTS) uniform Lights {
    vec4 intensity[max_lights];          // directional: irradiance on a facing plane, W/m²; else W/sr. w: 1 / range
    vec4 position[max_lights];           // w: 0 for a directional light
    vec4 direction[max_lights];          // of a directional light toward it, of a spot light its axis; unit length
    vec4 cone[max_lights];               // x, y: scale and offset of the axis' cosine; z: first camera; w: cameras
    mat4 clip_from_world[max_light_cameras];
    vec4 camera_axis[max_light_cameras]; // toward the camera, unit length; w: reach of the filter, metres per clip w
    int count;
    float size;                          // texels a side
    float depth_offset;                  // of a map's depth range
} lights;

layout(binding = SHADOW_MAPS) uniform sampler2DArray shadow_maps;

// Light of one light at a point, unshadowed.
struct Incident {
    vec3 to_light;    // unit length
    vec3 irradiance;  // on a facing plane, W/m²
};

// Attenuation by range and cone as KHR_lights_punctual recommends it.
Incident incident_light(int light, vec3 position) {
    vec4 intensity = lights.intensity[light];
    vec3 direction = lights.direction[light].xyz;
    if (lights.position[light].w == 0) return Incident(direction, intensity.rgb);

    // Term by term and `precise`: sums of it are the same on both APIs.
    precise vec3 offset = lights.position[light].xyz - position;
    precise float squared = max((offset.x * offset.x + offset.y * offset.y) + offset.z * offset.z, 1e-12);
    precise vec3 to_light = offset / sqrt(squared);
    precise float along = (direction.x * to_light.x + direction.y * to_light.y) + direction.z * to_light.z;
    precise float reach = squared * intensity.w * intensity.w;
    precise float window = clamp(1 - reach * reach, 0, 1);
    precise float cone = clamp(lights.cone[light].y - lights.cone[light].x * along, 0, 1);
    precise vec3 irradiance = intensity.rgb * (window * cone * cone / squared);
    return Incident(to_light, irradiance);
}

int light_camera(int light, vec3 position) {
    int first = int(lights.cone[light].z);
    if (lights.cone[light].w == 1) return first;
    vec3 offset = position - lights.position[light].xyz;
    vec3 size = abs(offset);
    int axis = size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    float along = axis == 0 ? offset.x : axis == 1 ? offset.y : offset.z;
    return first + 2 * axis + (along < 0 ? 1 : 0);
}

// 0 in shadow to 1 in light: 3 x 3 comparisons weighted by a box of two texels about the point, which makes the
// result continuous. Beside the map nothing casts.
//
// The map's depth is unbiased, so that others can take positions from it. The receiver is moved along its normal
// instead. A tap d away, in the plane through the receiver that faces the camera, sees a plane at angle t to it
// d tan t nearer; moving by o along the normal gains o / cos t; so o = d sin t is enough, exactly for a directional
// light and with something to spare in perspective, where d grows with clip w. It is at most 1.5 texels along each axis.
float light_visibility(int light, vec3 position, vec3 normal) {
    int index = light_camera(light, position);
    vec4 axis = lights.camera_axis[index];
    mat4 clip_from_world = lights.clip_from_world[index];
    float cosine = clamp(dot(normal, axis.xyz), -1, 1);
    float clip_w = transform(clip_from_world, vec4(position, 1)).w;
    vec3 receiver = position + normal * (axis.w * clip_w * sqrt(1 - cosine * cosine));
    vec4 clip = transform(clip_from_world, vec4(receiver, 1));
    if (clip.w <= 0) return 1.0;
    vec2 texel = (0.5 * (clip.xy / clip.w) + 0.5) * lights.size;
    float depth = clip.z / clip.w - lights.depth_offset;

    // The box covers part of the first row of texels, all of the second and the rest of the third.
    vec2 corner = floor(texel);
    vec2 f = texel - corner;
    vec3 weight_x = vec3(1 - f.x, 1, f.x);
    vec3 weight_y = vec3(1 - f.y, 1, f.y);
    ivec2 first = ivec2(corner) - 1;
    ivec2 last_texel = ivec2(int(lights.size) - 1);
    float sum = 0;
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) {
            ivec2 at = first + ivec2(x, y);
            bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThanEqual(at, last_texel));
            float occluder = inside ? texelFetch(shadow_maps, ivec3(at, index), 0).x : 1.0;
            sum += weight_x[x] * weight_y[y] * (depth <= occluder ? 1.0 : 0.0);
        }
    }
    return 0.25 * sum;
}
