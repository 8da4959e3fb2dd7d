#define MARKS 5
#include "voxels/raster_fragment.glsl"
