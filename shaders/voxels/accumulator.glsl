// Sums per voxel that come out the same in any order: integers, added atomically.
//
// The accumulator is an r32_uint volume with sum_words texels along x per cell; in a dense volume a voxel is its own
// cell. The words: red, green and blue of 8 bits times a weight; the weight, which is the fragment's share of surface
// area; where asked for, the components of the normal, as colours; and the weight times opacity. A word holds
// 2^32 / (255 * 64), about 263 000, fragments of full weight.

layout(constant_id = 2) const bool translucent = false;  // some surface is blended
layout(constant_id = 3) const bool normals = false;      // light is reflected on from voxel to voxel

const int word_color = 0;
const int word_weight = 3;
const int word_normal = 4;
const int word_opacity = normals ? 7 : 4;
const int sum_words = 4 + (normals ? 3 : 0) + (translucent ? 1 : 0);
const float weight_unit = 64.0;

ivec3 sum_texel(ivec3 cell, int word) {
    return ivec3(cell.x * sum_words + word, cell.yz);
}
