#define SAMPLER sampler1DArray
#define COORDINATE xy
#define RESULT vec4
#include "test_rhi/sample.glsl"
