// Empties what a dense volume holds of the listed blocks in texels of 32 bits, several along x a voxel.
#define BLOCKS 1
#include "voxels/own_cell.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push { int words; } push;

layout(binding = 0, r32ui) writeonly uniform uimage3D volume;

void main() {
    ivec3 cell = own_cell();
    if (cell.x < 0) return;
    int word = 0;
    do {
        imageStore(volume, ivec3(cell.x * push.words + word, cell.yz), uvec4(0));
        ++word;
    } while (word < push.words);
}
