#include "gbuffer/vertex.glsl"
