#include "gbuffer/fragment.glsl"
