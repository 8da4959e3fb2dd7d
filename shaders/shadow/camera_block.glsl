// The camera of a shadow map while it is drawn. The includer defines SHADOW, the block's binding.
#include "common/transform.glsl"

layout(std140, binding = SHADOW) uniform ShadowBlock {
    mat4 clip_from_world;  // depth grows away from the light
} shadow;
