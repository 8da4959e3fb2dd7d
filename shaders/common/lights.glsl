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
    vec4 camera_axis[max_light_cameras]; // toward the camera, unit length
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

// Change of depth over a plane, per texel of a map; `clip` is a point of it.
vec2 depth_slope(mat4 clip_from_world, vec4 clip, vec3 normal) {
    vec3 u = cross(normal, abs(normal.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
    vec4 along_u = transform(clip_from_world, vec4(u, 0));
    vec4 along_v = transform(clip_from_world, vec4(cross(normal, u), 0));
    vec3 ndc = clip.xyz / clip.w;
    vec3 du = along_u.xyz - ndc * along_u.w;
    vec3 dv = along_v.xyz - ndc * along_v.w;
    float area = du.x * dv.y - du.y * dv.x;
    vec2 slope = vec2(du.z * dv.y - dv.z * du.y, dv.z * du.x - du.z * dv.x) / area;
    return 2.0 / lights.size * slope;
}

// 0 in shadow to 1 in light: 3 x 3 comparisons weighted by a box of two texels about the point, which makes the
// result continuous. Beside the map nothing casts.
//
// The map's depth is unbiased, so that others can take positions from it. Instead each tap compares with the depth that
// the receiver's own plane has there, where that is nearer to the light: a plane does not shadow itself at any angle,
// while what stands out of it by a texel does. Half a texel of slope more is for what the plane is not: a curve, or a
// facet with a smooth normal.
float light_visibility(int light, vec3 position, vec3 normal) {
    int index = light_camera(light, position);
    mat4 clip_from_world = lights.clip_from_world[index];
    vec4 clip = transform(clip_from_world, vec4(position, 1));
    if (clip.w <= 0) return 1.0;
    vec2 slope = depth_slope(clip_from_world, clip, normal);
    vec2 texel = (0.5 * (clip.xy / clip.w) + 0.5) * lights.size;
    float depth = clip.z / clip.w - lights.depth_offset - 0.5 * (abs(slope.x) + abs(slope.y));

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
            float nearer = min(dot(slope, vec2(at) + 0.5 - texel), 0.0);
            sum += weight_x[x] * weight_y[y] * (depth + nearer <= occluder ? 1.0 : 0.0);
        }
    }
    return 0.25 * sum;
}
