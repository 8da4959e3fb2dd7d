// As surface, with the target of emission: only where something emits or is unlit.
#define EMISSION_TEXTURE 8
#include "gbuffer/fragment.glsl"
