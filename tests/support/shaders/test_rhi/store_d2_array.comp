#define IMAGE image2DArray
#define POSITION p
#include "test_rhi/store.glsl"
