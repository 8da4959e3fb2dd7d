#include "voxels/raster_vertex.glsl"
