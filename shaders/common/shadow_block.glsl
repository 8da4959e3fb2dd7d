// The shadow map of a directional light. The includer defines SHADOW, the block's binding. Filled by
// lumo::shadow::Shadow::record.
#include "common/transform.glsl"

layout(std140, binding = SHADOW) uniform ShadowBlock {
    mat4 clip_from_world;  // orthographic; depth grows away from the light
    mat4 world_from_clip;
    vec4 direction;        // toward the light, unit length
    float size;            // texels a side
    float normal_offset;   // metres, of a receiver whose plane holds the light
    float depth_offset;    // of the map's depth range
} shadow;
