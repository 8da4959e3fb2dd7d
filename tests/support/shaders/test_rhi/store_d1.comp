#define IMAGE image1D
#define POSITION p.x
#include "test_rhi/store.glsl"
