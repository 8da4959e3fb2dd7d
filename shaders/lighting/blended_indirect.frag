// As blended, lit by cones too.
#define INDIRECT
#include "lighting/blended.glsl"
