// One bit per voxel, in an r32_uint volume whose texels cover 4 x 4 x 2 voxels each, in Morton order: every byte of a
// word is a block of 2 x 2 x 2 voxels, and a pair of words along z one of 4 x 4 x 4.

ivec3 occupancy_texel(ivec3 voxel) { return voxel >> ivec3(2, 2, 1); }

// Place of the voxel's bit in its word.
uint occupancy_bit(ivec3 voxel) {
    uvec3 v = uvec3(voxel);
    return (v.x & 1u) | (v.y & 1u) << 1 | (v.z & 1u) << 2 | (v.x >> 1 & 1u) << 3 | (v.y >> 1 & 1u) << 4;
}
