#define SAMPLER isampler2D
#define COORDINATE xy
#define RESULT ivec4
#include "test_rhi/sample.glsl"
