#define SAMPLER usampler2D
#define COORDINATE xy
#define RESULT uvec4
#include "test_rhi/sample.glsl"
