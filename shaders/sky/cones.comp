// One of the further levels of the sky's map: means of level 0 over cones, each of a spiral of golden angles that has as
// much solid angle from turn to turn.
#define SKY_MAP 0
#include "common/constants.glsl"
#include "common/frame.glsl"
#include "sky/map.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push {
    int level;
    int samples;
} push;

layout(binding = 1, rgba32f) writeonly uniform image3D map;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(map).xy;
    if (any(greaterThanEqual(texel, size))) return;
    mat3 frame = frame_about(direction_at(2.0 * vec2(texel) / vec2(size - 1) - 1.0));
    float width = sky_map_cone(push.level);
    vec3 sum = vec3(0);
    for (int i = 0; i < push.samples; ++i) {
        float drop = 2.0 * width * width * (float(i) + 0.5) / float(push.samples);  // 1 - cosine
        float sine = sqrt(drop * (2.0 - drop));
        float turn = 2.399963 * float(i);
        sum += sky_map_at(place_of(frame * vec3(sine * cos(turn), sine * sin(turn), 1.0 - drop)), 0);
    }
    imageStore(map, ivec3(texel, 0), vec4(max(sum / float(push.samples), vec3(0)), 1));
}
