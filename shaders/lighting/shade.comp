#include "lighting/shade.glsl"
