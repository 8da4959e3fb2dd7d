#define IMAGE image3D
#define POSITION p
#include "test_rhi/store.glsl"
