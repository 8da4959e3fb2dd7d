// What the emitting voxels of a cubic cell of the grid amount to: lengths in voxels, positions in grid space.
struct EmitterCell {
    vec4 position_spread;  // their mean position; the mean of the squared distances from it
    vec4 flux;             // rgb: sum of radiance times area, in units of emission times voxel faces
    vec4 normal;           // xyz: mean normal; shorter, the more its surfaces face apart
};

float emitter_weight(EmitterCell cell) { return cell.flux.r + cell.flux.g + cell.flux.b; }

// Cells of all levels lie in one buffer, the finest level first, x fastest. `levels` have finest, finest / 2, … cells
// a side.
int first_cell(int finest, int level) {
    int first = 0;
    for (int i = 0; i < level; ++i) {
        int side = finest >> i;
        first += side * side * side;
    }
    return first;
}

int cell_index(ivec3 cell, int side) { return (cell.z * side + cell.y) * side + cell.x; }
