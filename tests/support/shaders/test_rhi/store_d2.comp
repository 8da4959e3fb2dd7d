#define IMAGE image2D
#define POSITION p.xy
#include "test_rhi/store.glsl"
