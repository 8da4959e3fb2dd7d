#define IMAGE imageCube
#define POSITION p
#include "test_rhi/store.glsl"
