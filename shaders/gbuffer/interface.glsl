// What the vertex and fragment stages of the G-buffer share.
#define GEOMETRY_VERTICES 0
#define GEOMETRY_INSTANCES 1
#define MATERIAL 2
#define CAMERA 3
#define BASE_COLOR_TEXTURE 4
#define METALLIC_ROUGHNESS_TEXTURE 5
#define NORMAL_TEXTURE 6
#define OCCLUSION_TEXTURE 7

#include "common/draw_push.glsl"
