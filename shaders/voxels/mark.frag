#define MARKS 5
#define FRAGMENTS 6
#include "voxels/raster_fragment.glsl"
