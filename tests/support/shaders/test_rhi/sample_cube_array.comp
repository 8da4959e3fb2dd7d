#define SAMPLER samplerCubeArray
#define COORDINATE xyzw
#define RESULT vec4
#include "test_rhi/sample.glsl"
