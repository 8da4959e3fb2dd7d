#define SAMPLER sampler2D
#define COORDINATE xy
#define RESULT vec4
#include "test_rhi/sample.glsl"
