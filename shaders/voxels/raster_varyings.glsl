// Between the stages of the voxelizer by the rasterizer. The includer defines VARYING, in or out.
layout(location = 0) VARYING vec2 uv0;
layout(location = 1) VARYING vec2 uv1;
layout(location = 2) VARYING vec4 color;
// The triangle as a height field over the two axes u and v that follow `axis` in cyclic order:
// height = anchor.z + slope . ((u, v) - anchor.xy), in grid space.
layout(location = 3) flat VARYING vec3 anchor;
layout(location = 4) flat VARYING vec2 slope;
layout(location = 5) flat VARYING uint axis;
layout(location = 6) flat VARYING float share;        // surface area of a fragment's share, in voxel faces
layout(location = 7) flat VARYING vec2 uv_per_voxel;  // length of one voxel in each uv set
layout(location = 8) flat VARYING vec3 facing;        // unit normal of the front side
layout(location = 9) flat VARYING vec2 extent;        // least and greatest height of the triangle
layout(location = 10) flat VARYING uint number;       // of the triangle, in all draws
