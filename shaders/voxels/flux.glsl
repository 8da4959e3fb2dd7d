// Light of the analytic lights per voxel: the words that voxels/light.comp sums in an r32_uint volume, flux_words texels
// along x per cell. What of the surfaces is lit, and unless one directional light is all there is the flux too, in red,
// green and blue.

layout(constant_id = 30) const bool several_lights = false;  // anything but one directional light

const int flux_words = several_lights ? 4 : 1;

ivec3 flux_texel(ivec3 cell, int word) { return ivec3(cell.x * flux_words + word, cell.yz); }
