// A ray through a grid from voxel to voxel, across their faces (Amanatides & Woo 1987, A Fast Voxel Traversal Algorithm
// for Ray Tracing). In grid space.
struct Walk {
    ivec3 voxel;
    ivec3 way;    // to the next voxel along each axis
    vec3 leaves;  // where along the ray it leaves the voxel through each axis' face, in lengths of its direction
    vec3 across;  // from one face to the next of an axis
};

// In the voxel that holds the point. `precise`: which voxel comes next must not hang on how a compiler rounds.
Walk start_walk(vec3 origin, vec3 direction, ivec3 voxel) {
    // An axis along which the ray does not move is never the next one.
    precise vec3 moving = mix(direction, vec3(1e-12), equal(direction, vec3(0)));
    ivec3 way = ivec3(sign(moving));
    precise vec3 leaves = (vec3(voxel) + max(vec3(way), 0.0) - origin) / moving;
    return Walk(voxel, way, leaves, abs(1.0 / moving));
}

// Where along the ray it leaves the voxel.
float leaves_voxel(Walk walk) { return min(walk.leaves.x, min(walk.leaves.y, walk.leaves.z)); }

void step_walk(inout Walk walk) {
    if (walk.leaves.x < walk.leaves.y && walk.leaves.x < walk.leaves.z) {
        walk.voxel.x += walk.way.x;
        walk.leaves.x += walk.across.x;
    } else if (walk.leaves.y < walk.leaves.z) {
        walk.voxel.y += walk.way.y;
        walk.leaves.y += walk.across.y;
    } else {
        walk.voxel.z += walk.way.z;
        walk.leaves.z += walk.across.z;
    }
}
