#include "shadow/surface.glsl"
