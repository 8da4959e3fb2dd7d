// What the programs of the shadow map share.
#define GEOMETRY_VERTICES 0
#define GEOMETRY_INSTANCES 1
#define SHADOW 2
#define MATERIAL 3
#define BASE_COLOR_TEXTURE 4

#include "common/draw_push.glsl"
