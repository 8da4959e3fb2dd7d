#define SAMPLER sampler1D
#define COORDINATE x
#define RESULT vec4
#include "test_rhi/sample.glsl"
