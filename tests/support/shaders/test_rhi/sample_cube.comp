#define SAMPLER samplerCube
#define COORDINATE xyz
#define RESULT vec4
#include "test_rhi/sample.glsl"
