// A cubic grid of voxels over part of the world.
//
// Grid space: voxel (i, j, k) covers [i, i+1) x [j, j+1) x [k, k+1), axes along the world's.

struct VoxelGrid {
    vec3 origin;             // world position of grid space's origin, metres
    float voxels_per_metre;
};

vec3 grid_from_world(VoxelGrid grid, vec3 world) {
    return (world - grid.origin) * grid.voxels_per_metre;
}

vec3 world_from_grid(VoxelGrid grid, vec3 position) {
    return grid.origin + position / grid.voxels_per_metre;
}

bool inside_grid(ivec3 voxel, int resolution) {
    return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, ivec3(resolution)));
}

// The surface area inside a voxel, in voxel faces, is kept in 8 bits next to the albedo: as a square root, so that
// a few faces and a thicket both keep a relative precision. 0 is an empty voxel.
const float max_voxel_area = 16.0;

float encode_area(float area) {
    return clamp(sqrt(area / max_voxel_area), 1.0 / 255.0, 1.0);
}

float decode_area(float encoded) {
    return encoded * encoded * max_voxel_area;
}
