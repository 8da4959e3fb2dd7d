// As shade, with the parts of the radiance beside it.
#define LAYERS
#include "lighting/shade.glsl"
