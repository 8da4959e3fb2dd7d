#include "lighting/blended.glsl"
