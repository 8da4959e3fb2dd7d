// Emitters that cones are sent to one by one.
#include "cones/emitter_cell.glsl"

const int max_emitters = 32;

// The layout of the block. Lengths in voxels, positions in grid space; flux in W/sr per squared voxel.
#define EMITTER_BLOCK            \
    float share;                 \
    int count;                   \
    ivec2 padding;               \
    EmitterCell data[max_emitters];
